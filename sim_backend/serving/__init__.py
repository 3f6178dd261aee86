"""The simulated bench in wall-clock time, at the other end of real or pseudo wires."""

from sim_backend.serving._loop import BenchServer, BusServer, Pace
from sim_backend.serving._slcan_port import SlcanPort
from sim_backend.serving._socketcan_port import SocketcanPort
from sim_backend.serving._socketcand_port import SocketcandPort
from sim_backend.serving._udp_hub import UdpHub

__all__ = ["BenchServer", "BusServer", "Pace", "SlcanPort", "SocketcanPort", "SocketcandPort", "UdpHub"]
