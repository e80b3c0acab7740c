#!/usr/bin/env bash
# FMPy 0.3.32 drops the offset of a unit when it sets a start value: 80 degrees Celsius are set as 80 K.
#
# Expected: 353.15 K. A start value may be a pair of a number and a unit; `DisplayUnit` of FMI 2.0.4 has factor and offset, and the offset is left out
# only if `relativeQuantity` is true, for differences. FMPy does so for every variable with a `declaredType`, because a type that does not say
# `relativeQuantity` is taken for one that does. Exporters from Modelica give each temperature and pressure a declared type. The unit of a variable
# without a type is converted right.
# Do instead: pass start values in the unit of the variable.
#
# Seen:
# oil (declaredType): 80 degC is set as 80.00 K
# air (no type):      80 degC is set as 353.15 K
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet fmpy==0.3.32 pythonfmu==0.7.0 numpy==2.4.6
cd "$folder"
cat > Bath.py <<'PYTHON'
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Bath(Fmi2Slave):
    """Two temperatures, which stay as they were set."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.oil, self.air, self.oil_out, self.air_out = 300.0, 300.0, 0.0, 0.0
        for name in ("oil", "air"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))
            self.register_variable(Real(f"{name}_out", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.oil_out, self.air_out = self.oil, self.air
        return True
PYTHON
"$folder/venv/bin/pythonfmu" build --file Bath.py
"$folder/venv/bin/python" - <<'PYTHON'
import zipfile

import fmpy
from fmpy.validation import validate_fmu

assert fmpy.__version__ == "0.3.32", fmpy.__version__
KELVIN = '<UnitDefinitions><Unit name="K"><BaseUnit K="1"/><DisplayUnit name="degC" factor="1" offset="-273.15"/></Unit></UnitDefinitions>'
TYPE = '<TypeDefinitions><SimpleType name="Temperature"><Real unit="K" displayUnit="degC"/></SimpleType></TypeDefinitions>'
UNKNOWNS = '<InitialUnknowns><Unknown index="2"/><Unknown index="4"/></InitialUnknowns>'


def with_units(description: str) -> str:
    """The description with units, of "oil" by a type, of "air" by its own attribute, and the unknowns that the standard wants listed."""
    description = description.replace("<LogCategories>", KELVIN + TYPE + "<LogCategories>").replace("</Outputs>", "</Outputs>" + UNKNOWNS)
    for name, unit in (("oil", 'declaredType="Temperature" unit="K"'), ("air", 'unit="K"')):
        begin = description.index("<Real ", description.index(f'name="{name}"'))
        description = f"{description[:begin]}<Real {unit} {description[begin + 6:]}"
    return description


with zipfile.ZipFile("Bath.fmu") as made, zipfile.ZipFile("Units.fmu", "w") as units:
    for name in made.namelist():
        data = made.read(name)
        units.writestr(name, with_units(data.decode()).encode() if name == "modelDescription.xml" else data)
assert validate_fmu("Units.fmu") == [], "the file is valid"

told = fmpy.simulate_fmu("Units.fmu", start_values={"oil": (80.0, "degC"), "air": (80.0, "degC")}, stop_time=1.0, output_interval=0.5)
oil, air = float(told["oil_out"][-1]), float(told["air_out"][-1])
print(f"oil (declaredType): 80 degC is set as {oil:.2f} K")
print(f"air (no type):      80 degC is set as {air:.2f} K")
assert abs(air - 353.15) < 1e-9
assert abs(oil - 80.0) < 1e-9, "the offset is taken into account now: the finding has ended"
PYTHON
