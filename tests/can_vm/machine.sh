#!/bin/bash
# machine.sh DIR: boots Debian's own kernel in a small emulated machine with a real SocketCAN, on this machine's
# root file system (read-only, writes go to memory), runs DIR/run.sh in it and exits with its exit code.
# There are vcan and two buses with two kvaser_pci controllers each: simcan0 and simcan1, simcan2 and simcan3.
# DIR is /mnt/out inside: only what is written there lasts. If there is a DIR/disk, its lines are the places at
# which the folders 0, 1, ... of the disk image $CAN_VM_DISK are mounted.
# Its one processor takes 2 ns for an instruction, by its own clock: a machine outside that is slow or busy makes
# all of it last longer, and changes nothing inside. With two, the one that takes frames from a controller could be
# kept waiting outside while the other sends: frames were lost that no real machine loses.
# Environment: CAN_VM_CACHE (default ~/.cache/hil-can-vm: kernel and boot image), LIMIT (seconds, default 2400).
set -euo pipefail
OUT=$(realpath "$1"); CACHE=${CAN_VM_CACHE:-$HOME/.cache/hil-can-vm}; mkdir -p "$CACHE"; cd "$CACHE"
if [ ! -s initrd.gz ]; then
  rm -rf kernel initrd busybox ./*.deb
  IMAGE=$(apt-cache depends linux-image-amd64 | sed -n 's/.*Depends: //p' | head -1)
  [ -n "$IMAGE" ] || { echo "apt knows no linux-image-amd64" >&2; exit 77; }
  apt-get -qq -o APT::Sandbox::User=root download "$IMAGE" busybox-static >&2 || exit 77
  dpkg -x "$IMAGE"*.deb kernel; dpkg -x busybox-static*.deb busybox; rm ./*.deb
  BUSYBOX=$PWD/busybox/bin/busybox; VERSION=${IMAGE#linux-image-}
  mkdir -p initrd/{bin,proc,sys,dev,lo,up,root} "initrd/lib/modules/$VERSION"; cp "$BUSYBOX" initrd/bin/busybox
  (cd "kernel/lib/modules/$VERSION" && cp --parents -r modules.order modules.builtin kernel/net/can \
     kernel/drivers/net/can kernel/drivers/virtio kernel/drivers/block/virtio_blk.ko kernel/net/9p \
     kernel/fs/{9p,netfs,fscache,overlayfs,ext4,jbd2,mbcache.ko} kernel/lib/{crc16,libcrc32c}.ko \
     kernel/crypto/crc32c_generic.ko "$CACHE/initrd/lib/modules/$VERSION")
  "$BUSYBOX" depmod -b "$PWD/initrd" "$VERSION"
  cat > initrd/init <<'I'
#!/bin/busybox sh
/bin/busybox --install -s /bin; export PATH=/bin
mount -t proc p /proc; mount -t sysfs s /sys; mount -t devtmpfs d /dev
modprobe -a virtio_pci virtio_blk crc32c_generic ext4 9pnet_virtio 9p overlay vcan can-raw can-bcm can-gw slcan kvaser_pci
mount -t 9p -o trans=virtio,version=9p2000.L,ro,cache=loose,msize=512000 root /lo
mount -t tmpfs t /up; mkdir /up/u /up/w; mount -t overlay -o lowerdir=/lo,upperdir=/up/u,workdir=/up/w o /root
mkdir -p /root/mnt/out; mount -t 9p -o trans=virtio,version=9p2000.L,msize=512000 out /root/mnt/out
for d in proc sys dev; do mount --move /$d /root/$d; done
if [ -s /root/mnt/out/disk ]; then  # a file of Python's own on a disk is read far faster than over 9p
  mkdir /disk; mount -t ext4 -o ro /root/dev/vda /disk
  n=0; while read -r place; do mount -o bind /disk/$n "/root$place"; n=$((n+1)); done < /root/mnt/out/disk
fi
mkdir -p /root/dev/pts /root/dev/shm; mount -t devpts p /root/dev/pts
for d in dev/shm run; do mount -t tmpfs t /root/$d; done
cp -a /lib/modules/* /root/lib/modules/ 2>/dev/null; cp /bin/busybox /root/usr/bin/busybox-vm
exec switch_root /root /bin/sh -c 'export HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
ip link set lo up; for n in 0 1 2 3; do ip link set can$n name simcan$n; done
cd /mnt/out; setsid sh ./run.sh; echo $? > rc; sync; busybox-vm poweroff -f'
I
  chmod +x initrd/init
  (cd initrd && find . | "$BUSYBOX" cpio -o -H newc 2>/dev/null | gzip -1 > ../initrd.gz.part)
  mv initrd.gz.part initrd.gz
fi
rm -f "$OUT/rc"
set +e
DISK=()
[ -z "${CAN_VM_DISK:-}" ] || DISK=(-drive "file=$CAN_VM_DISK,format=raw,if=virtio,readonly=on")
timeout -k 5 "${LIMIT:-2400}" qemu-system-x86_64 -accel tcg,thread=single -icount shift=1 -cpu max -smp 1 -m 1536 -nographic -nodefaults \
  -no-reboot -serial stdio -monitor none -kernel kernel/boot/vmlinuz-* -initrd initrd.gz \
  -append "console=ttyS0 quiet panic=-1 mitigations=off tsc=reliable" \
  -fsdev local,id=r,path=/,security_model=none,readonly=on,multidevs=remap \
  -device virtio-9p-pci,fsdev=r,mount_tag=root \
  -fsdev local,id=o,path="$OUT",security_model=none -device virtio-9p-pci,fsdev=o,mount_tag=out \
  "${DISK[@]}" -object can-bus,id=rmcu -object can-bus,id=dyno \
  -device kvaser_pci,canbus=rmcu -device kvaser_pci,canbus=rmcu \
  -device kvaser_pci,canbus=dyno -device kvaser_pci,canbus=dyno </dev/null
[ -s "$OUT/rc" ] || { echo "the emulated machine did not end by itself" >&2; exit 124; }
exit "$(cat "$OUT/rc")"
