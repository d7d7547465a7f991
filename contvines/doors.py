"""The doors of `contvines`; what lies behind them is said in `contvines/__init__.py`."""

from contvines.shared.doors import Doors

_DOORS = Doors()
lead, above = _DOORS.lead, _DOORS.above
