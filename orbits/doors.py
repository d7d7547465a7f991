"""The doors of `orbits`; what lies behind them is said in `orbits/__init__.py`."""

from contvines.shared.doors import Doors

_DOORS = Doors()
lead, above = _DOORS.lead, _DOORS.above
