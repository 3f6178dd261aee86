"""The script in an exported unit; it runs where the package eaxle-hil is installed."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability, Real

try:
    from hil.core.controller import load_controller
    from hil.core.model import load_model
    from hil.fmu.axle import OUTPUTS, Axle
except ImportError as error:
    raise ImportError(
        "this unit computes with the Python package eaxle-hil: install it for this Python"
    ) from error


#: SI exponents by unit (FMI 2.0.4, 2.2.2).
_UNITS = {
    "N.m": {"kg": "1", "m": "2", "s": "-2"},
    "rad/s": {"rad": "1", "s": "-1"},
    "m/s": {"m": "1", "s": "-1"},
    "m": {"m": "1"},
}
_ENDINGS = (("_nm", "N.m"), ("_rad_s", "rad/s"), ("_m_s", "m/s"), ("_m", "m"))


class EAxle(Fmi2Slave):  # type: ignore[misc]
    """An electric axle in its vehicle, with its controller if it was exported with one."""

    description = "Electric axle; needs Python with the package eaxle-hil"
    default_experiment = DefaultExperiment(start_time=0.0, stop_time=10.0, step_size=0.001)

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._axle: Axle | None = None
        controlled = (Path(self.resources) / "controller.toml").is_file()
        asked = "driving_torque_ref_nm" if controlled else "motor_torque_ref_nm"
        self._asked = asked
        self.initial_speed_m_s = 0.0
        self.wheel_radius_m = 0.33
        for name, about in (("initial_speed_m_s", "of the vehicle"), ("wheel_radius_m", "of the tyre")):
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable,
                     initial=Fmi2Initial.exact, start=getattr(self, name), description=about)
            )  # fmt: skip
        setattr(self, asked, 0.0)
        self.register_variable(
            Real(asked, causality=Fmi2Causality.input, start=0.0, description="torque that is asked for, N.m")
        )
        self._shown = [name for name in OUTPUTS if name != asked]
        for name in self._shown:
            unit, about, _, _ = OUTPUTS[name]
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.output, description=f"{about}, {unit}"))

    def to_xml(self, model_options: Any = None) -> Any:
        """As FMI 2 wants it: units, and outputs known from the beginning (pythonfmu leaves both out)."""
        root = super().to_xml(model_options or {})
        _add_units(root)
        structure = root.find("ModelStructure")
        known = SubElement(structure, "InitialUnknowns")
        for output in structure.find("Outputs"):
            SubElement(known, "Unknown", attrib=dict(output.attrib))
        return root

    def exit_initialization_mode(self) -> None:
        """The parameters are known: bring the wheels to their speed."""
        folder = Path(self.resources)
        file = folder / "controller.toml"
        controller = load_controller(file) if file.is_file() else None
        model = load_model(folder / "model.toml")
        self._axle = Axle(model, controller, self.wheel_radius_m, self.initial_speed_m_s)
        self._show(self._axle)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """A whole number of milliseconds."""
        del current_time
        assert self._axle is not None
        self._axle.torque_nm = getattr(self, self._asked)
        self._axle.step(step_size)
        self._show(self._axle)
        return True

    def _show(self, axle: Axle) -> None:
        values = axle.outputs()
        for name in self._shown:
            setattr(self, name, values[name])


def _add_units(root: Element) -> None:
    """Give each variable its unit, and define the units between the kind of the model and what follows it."""
    units = Element("UnitDefinitions")
    for name, exponents in _UNITS.items():
        SubElement(SubElement(units, "Unit", name=name), "BaseUnit", exponents)
    root.insert(1, units)
    for variable in root.iterfind("ModelVariables/ScalarVariable"):
        name = variable.attrib["name"]
        unit = next(unit for ending, unit in _ENDINGS if name.endswith(ending))
        variable[0].set("unit", unit)
