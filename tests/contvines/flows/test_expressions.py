"""Flows from SymPy expressions and from XPP's files."""

import numpy as np
import pytest
import sympy

import contvines as cv
from contvines.flows import read_ode

t = sympy.Symbol("t")
PERIOD = 6.6632868593231301  # van der Pol's cycle at mu = 1: Urabe and others; many digits in the literature

ODE = """# van der Pol with a function and a fixed quantity
par mu=1, k=1.0
init x=1, y=0
damping(u)=mu*(1-u^2)
pull=k*x
dx/dt=y
y'=damping(x)*y - pull
aux energy=x^2+y^2
@ total=100
done
"""


def test_sympy_gives_what_python_gives():
    x, y, mu = sympy.symbols("x y mu")
    flow = cv.FlowProblem.from_sympy([y, mu * (1 - x**2) * y - x], [x, y], [1.0, 0.0], {"mu": 1.0})
    assert flow.attractor().period == pytest.approx(PERIOD, abs=1e-8)
    with pytest.raises(ValueError, match="mu"):
        cv.FlowProblem.from_sympy([y, mu * y - x], [x, y], [1.0, 0.0], {"nu": 1.0})


def test_functions_of_time_and_absolute_values_of_sympy():
    """v' = -c |v| v - x cos t: its derivative by v is -2 c |v|."""
    t, c = sympy.symbols("t c")
    x, v = sympy.Function("x")(t), sympy.Function("v")(t)
    flow = cv.FlowProblem.from_sympy(
        [v, -c * sympy.Abs(v) * v - x * sympy.cos(t)],
        [x, v],
        [1.0, 0.5],
        {"c": 0.3},
        time=t,
        period=2 * np.pi,
    )
    assert flow.states == ("x", "v")
    slope = flow.field.jacobian(np.array([[0.2, -0.5]]), 0.3, np.array([1.2]))[0]
    assert slope == pytest.approx(np.array([[0.0, 1.0], [-np.cos(1.2), -0.3]]), abs=1e-14)


@pytest.fixture
def read(tmp_path):
    """Reads a file of XPP with this text."""

    def go(text, **options):
        (tmp_path / "flow.ode").write_bytes(text.encode("latin-1"))
        return read_ode(tmp_path / "flow.ode", **options)

    return go


def test_a_file_of_xpp(read):
    flow = read(ODE)
    assert flow.values.values == {"mu": 1.0, "k": 1.0}
    assert np.array_equal(flow.x0, [1.0, 0.0])
    assert flow.attractor().period == pytest.approx(PERIOD, abs=1e-8)


def test_names_that_begin_like_words_of_xpp(read):
    """``auxin`` is a state, ``partial`` and ``i`` are fixed quantities."""
    flow = read("""par a=2 b = 0.5, c=1
p d=4
init auxin=1 set=2
partial=a*auxin
i = b + set
number e=3
auxin' = partial - i*c
dset/dt=d*auxin-e*set
initial'=-initial
aux power=partial
done""")
    assert flow.states == ("auxin", "set", "initial")
    assert flow.values.values == {"a": 2.0, "b": 0.5, "c": 1.0, "d": 4.0, "e": 3.0}
    assert flow.x0.tolist() == [1.0, 2.0, 0.0]
    # 2 x 1.5 - (0.5 + 0.5), 4 x 1.5 - 3 x 0.5
    assert flow.field(np.array([[1.5, 0.5, 2.0]]), 2.0).tolist() == [[2.0, 4.5, -2.0]]


def test_a_file_of_xpp_with_lines_that_go_on_and_derived_parameters(read):
    """The model of Morris and Lecar (Rinzel and Ermentrout 1998); its Hopf points are those of docs/demos.md, solved in thirty digits."""
    flow = read("""# Morris and Lecar
p Iapp=50, gCa=4.4
param gK=8 C=20
!ratio=1/C
options ml.opt
V(0)=-60
w(0)=.01
minf(V)=.5*(1+tanh((V+1.2)/18))
winf(V)=.5*(1+tanh((V-2)/30))
dV/dt=(Iapp-2*(V+60)-gCa*minf(V)*(V-120) \\
   -gK*w*(V+84))*ratio
dw/dt=.04*cosh((V-2)/60)*(winf(V)-w)
aux Ica=gCa*minf(V)*(V-120)
export {v} {w}
@ xp=V,yp=w
done
""")
    assert list(flow.values.values) == ["iapp", "gca", "gk", "c"]
    found = cv.diagram(flow, over="iapp", within=(0, 300), depth=0).of_kind("hopf")
    assert [point.value for point in found] == pytest.approx([93.857618374, 212.0188161], abs=1e-7)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("x'=a*x", "'a'"),
        ("par a=1\nx'=-a*x \\\n  +1\ny'=b", "line 4.*'b' is no state"),
        ("x'=__import__('os')", "can be read"),
        ("x'=x.real", "can be read"),
        ("par a", "name=value"),
        ("table f % 10", "line 1.*tables are not read"),
        ("par a=1\nx'=-a*x+w\nwiener w", "line 3.*random"),
        ("par a=1\nx'=-a*x+normal(0,1)", "line 2.*random"),
        ("par a=1\nx'=-a*x\nglobal 1 x-2 {x=0}", "line 3.*motions that jump"),
        ("par a=1\nx'=-a*delay(x,2)", "line 2.*past"),
        ("par a=1\nx'=-a*x*(x>1)", "line 2.*comparisons"),
        ("par a=1\nx(t+1)=a*x", "line 2.*cv.MapProblem"),
        ("par a=1\nx[1..3]'=-a*x[j]", "line 2.*arrays"),
        ("par a=1\n0=z-x\nsolv z=0\nx'=z-a*x", "line 2.*solve them"),
        ("par a=1\n#include b.ode\nx'=-a*x", "line 2.*not included"),
        ("par a=one\nx'=a*x", "no number"),
        ("par a=1", "no equation"),
        ("x'=-x", "no parameter"),
        ("par a=1\nx'=a*+x*/2", "line 2.*no formula"),
        ("par a=1\nx'=(a,x)", "line 2.*no formula"),
        ("par a=1\nx'=a*x\nx'=-x", "line 3.*'x' is there twice"),
        ("par a=1\na=2\nx'=a*x", "'a' is there twice"),
        ("par exp=1\nx'=-x", "'exp' is that of a function"),
        ("par a=1\ninit y=2\nx'=a*x", "line 2.*'y' is no state"),
        ("par a=1\nx'=b\nb=c\nc=a", "line 3.*'c' is further down"),
        ("par a=1\nf(u,v)=u*v\nx'=f(a)", "f has 2 argument"),
        ("par a=1\nx'=a(x)", "'a' is no function"),
        ("par a=1\nx'=sin", "'sin' is no state"),
        ("par a=1\nx'=cos(t)-a*x", "line 2.*depends on the time t; give period="),
        ("par a=1\nb(s)=s*t\nx'=b(x)-a*x", "line 2.*depends on the time t"),
    ],
)
def test_what_cannot_be_read_is_told_with_its_line(read, line, words):
    with pytest.raises(ValueError, match=words):
        read(line + "\n")


def test_a_forced_file_of_xpp_with_words_of_python(read):
    """x' = -lambda x + cos t settles on (lambda cos t + sin t) / (lambda^2 + 1)."""
    text = "# \xe9tude\npar lambda=2\nif=cos(t)\ndecay(t)=lambda*t\nx'=if-decay(x)\ndone\n"
    flow = read(text, period=2 * np.pi)
    assert flow.attractor()(1.0)[0] == pytest.approx((2 * np.cos(1.0) + np.sin(1.0)) / 5, abs=1e-7)


@pytest.mark.parametrize(
    ("expressions", "options", "words"),
    [
        (["v"], {}, "1 expressions for 2 states"),
        (["v +", "-x"], {}, "'v .' is no expression"),
        ([None, "-x"], {}, "None is no expression"),
        (["v", "-c*v - x + cos(t)"], {"time": t}, "time= and period= belong together"),
        (["v", "-c*v - x"], {"period": 1.0}, "time= and period= belong together"),
        (["v", "-c*v - x"], {"params": 1.0}, "params = 1.0 must be values by name"),
        (["v", "-c*v - x"], {"params": {"v": 1.0}}, "'v' is there twice"),
    ],
)
def test_what_cannot_be_read_of_sympy(expressions, options, words):
    with pytest.raises(ValueError, match=words):
        cv.FlowProblem.from_sympy(
            expressions, ["x", "v"], [1.0, 0.5], options.pop("params", {"c": 0.3}), **options
        )


def test_a_step_of_sympy():
    """Beside the step its derivative is zero."""
    x, a = sympy.symbols("x a")
    flow = cv.FlowProblem.from_sympy([a * sympy.Heaviside(x) - x], [x], [0.5], {"a": 1.0})
    assert flow.field.jacobian(np.array([[0.5]]), 1.0)[0, 0, 0] == -1.0
