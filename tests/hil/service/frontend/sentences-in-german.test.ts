// Sentences of the engine, one in another, in a language other than their own: no part stays English.

import assert from "node:assert/strict";
import test from "node:test";
import { CATALOGUE } from "../../../../hil/service/frontend/src/i18n/language.ts";
import { catalogueOf } from "../../../../hil/service/frontend/texts.ts";

Object.assign(CATALOGUE, catalogueOf("de")); // before anything that keeps texts as constants is imported
const { linesOf, translated } = await import("../../../../hil/service/frontend/src/i18n/phrases.ts");

const IN_GERMAN: Record<string, string> = {
  "rear left: heartbeat lost; rear right: drive in fault": "hinten links: Heartbeat ausgeblieben; hinten rechts: Antrieb auf Störung",
  "dyno 'rear left' (node 3): refused vehicle inertia (object 0x2000, subindex 1) = 12: the value is above its range (SDO abort 0x06090031)": "Dynamometer „hinten links“ (Knoten 3): hat Fahrzeugträgheit (Objekt 0x2000, Subindex 1) = 12 abgelehnt: der Wert liegt über seinem Bereich (SDO-Abbruch 0x06090031)",
  "bus 'rmcu' (socketcan can0): cannot be opened: its driver is not installed (No module named 'x')": "Bus „rmcu“ (socketcan can0): lässt sich nicht öffnen: sein Treiber ist nicht installiert (No module named 'x')",
  "bus 'dyno': sending failed: the adapter is gone: unplugged, or its driver was unloaded (No such device)": "Bus „dyno“: Senden fehlgeschlagen: der Adapter ist weg: abgezogen, oder sein Treiber wurde entladen (No such device)",
  "RMCU did not confirm its safe state within 0.5 s; dynos did not confirm its safe state within 0.5 s: sending failed: the other end is no longer connected (Connection refused)": "RMCU hat den sicheren Zustand nicht innerhalb von 0.5 s bestätigt; Dynamometer hat den sicheren Zustand nicht innerhalb von 0.5 s bestätigt: Senden fehlgeschlagen: die Gegenstelle ist nicht mehr verbunden (Connection refused)",
  "bus 'rmcu' (hil-udp 127.0.0.1:7): cannot be opened: no simulated bench at 127.0.0.1:7; start one with 'hil bench sim'": "Bus „rmcu“ (hil-udp 127.0.0.1:7): lässt sich nicht öffnen: kein simulierter Prüfstand unter 127.0.0.1:7; mit „hil bench sim“ einen starten",
  "RMCU: the RMCU's frames come with wrong checksums (bus 'rmcu': 80 of 500 frames RMCU_Control are damaged (wrong checksum))": "RMCU: die Frames der RMCU haben falsche Prüfsummen (Bus „rmcu“: 80 von 500 Frames RMCU_Control sind beschädigt (falsche Prüfsumme))",
  "dynos: rear left: EMCY 0x2320 Current; rear left: drive in fault": "Dynamometer: hinten links: EMCY 0x2320 (Strom); hinten links: Antrieb auf Störung",
  "ram: 42% of its samples are lost; the slave says 69 times that it is overloaded": "ram: 42% seiner Abtastwerte sind verloren; der Slave meldet 69-mal, dass er überlastet ist",
  "device 'panel' (socket://10.0.0.7:5000): sending failed: 0 of 9 bytes were taken": "Gerät „panel“ (socket://10.0.0.7:5000): Senden fehlgeschlagen: 0 von 9 Bytes wurden angenommen",
  "device 'panel': EMAS 1400: the panel is not in remote mode: it is operated by hand": "Gerät „panel“: EMAS 1400: das Bedienpanel ist nicht auf Fernbedienung: es wird von Hand bedient",
  "plan, segment 'step': requests 400 N m of driving torque, the bench allows 350 N m": "Plan, Abschnitt „step“: fordert 400 N m (Antriebsmoment), der Prüfstand erlaubt 350 N m",
  "segment 's': shaft_torque_nm is 2.5 times what motor_torque_nm demands (T_s = N T_m, less friction), 0.8 to 1.2 would agree: a sensor is dead, scaled or mirrored": "Abschnitt „s“: Wellenmoment ist das 2.5-Fache dessen, was Motormoment verlangt (T_s = N T_m, weniger Reibung), 0.8 bis 1.2 würden passen: ein Sensor ist tot, falsch skaliert oder gespiegelt",
  "ends after 4 s: stopped once more; the axle turns: motor_speed_rad_s reads 138 rad/s": "das Auslaufen endet nach 4 s: noch einmal gestoppt; die Achse dreht: Motordrehzahl 138 rad/s",
};

for (const [text, words] of Object.entries(IN_GERMAN)) test(`in German: ${text}`, () => assert.equal(translated(text), words));

test("what is wrong and what to do are lines of an error, and part of one line of an event", () => {
  const lines = ["bus 'dyno': the network interface is down", "check [buses] in the bench file, the adapter and its driver"];
  for (const between of ["\n  ", "   "]) assert.deepEqual(linesOf(lines.join(between)), [lines[0], between, lines[1]]);
  const fields = "2 fields are wrong\n  reason is missing\n  ends is missing";
  assert.deepEqual(linesOf(fields), [fields]);
});
