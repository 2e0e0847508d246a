"""NIST's statistical reference datasets for nonlinear regression, of the higher level of difficulty, from both starts.

Data, starts and certified values: NIST/ITL StRD, https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml.
"""

import numpy as np
import pytest

from control.least_squares import Rules, minimise

BOXBOD = {
    "model": lambda b, x: b[0] * (1 - np.exp(-b[1] * x)),
    "x": """
        1 2 3 5 7 10
    """,
    "y": """
        109 149 149 191 213 224
    """,
    "starts": [[1, 1], [100, 0.75]],
    "bounds": [[0, 0], [1000, 10]],
    "certified": np.array([213.80940889, 0.54723748542]),
    "squares": 1.1680088766e03,
}
ECKERLE4 = {
    "model": lambda b, x: b[0] / b[1] * np.exp(-0.5 * ((x - b[2]) / b[1]) ** 2),
    "x": """
        400 405 410 415 420 425 430 435 436.5 438 439.5 441 442.5 444 445.5 447 448.5 450 451.5 453 454.5 456
        457.5 459 460.5 462 463.5 465 470 475 480 485 490 495 500
    """,
    "y": """
        0.0001575 0.0001699 0.000235 0.0003102 0.0004917 0.000871 0.0017418 0.00464 0.0065895 0.0097302
        0.0149002 0.023731 0.0401683 0.0712559 0.1264458 0.2073413 0.2902366 0.3445623 0.3698049 0.3668534
        0.3106727 0.2078154 0.1164354 0.0616764 0.03372 0.0194023 0.0117831 0.0074357 0.0022732 0.00088
        0.0004579 0.0002345 0.0001586 0.0001143 7.1e-05
    """,
    "starts": [[1, 10, 500], [1.5, 5, 450]],
    "bounds": [[0, 1, 400], [10, 50, 500]],
    "certified": np.array([1.5543827178, 4.0888321754, 451.54121844]),
    "squares": 1.4635887487e-03,
}
RAT43 = {
    "model": lambda b, x: b[0] / (1 + np.exp(b[1] - b[2] * x)) ** (1 / b[3]),
    "x": """
        1 2 3 4 5 6 7 8 9 10 11 12 13 14 15
    """,
    "y": """
        16.08 33.83 65.8 97.2 191.55 326.2 386.87 520.53 590.03 651.92 724.93 699.56 689.96 637.56 717.41
    """,
    "starts": [[100, 10, 1, 1], [700, 5, 0.75, 1.3]],
    "bounds": [[0, 0, 0, 0.1], [2000, 20, 5, 5]],
    "certified": np.array([699.6415127, 5.2771253025, 0.75962938329, 1.2792483859]),
    "squares": 8.7864049080e03,
}
MGH10 = {
    "model": lambda b, x: b[0] * np.exp(b[1] / (x + b[2])),
    "x": """
        50 55 60 65 70 75 80 85 90 95 100 105 110 115 120 125
    """,
    "y": """
        34780 28610 23650 19630 16370 13720 11540 9744 8261 7030 6005 5147 4427 3820 3307 2872
    """,
    "starts": [[2, 400000, 25000], [0.02, 4000, 250]],
    "bounds": [[1e-09, 0, 0], [10, 500000, 30000]],
    "certified": np.array([0.005609636471, 6181.3463463, 345.22363462]),
    "squares": 8.7945855171e01,
}
THURBER = {
    "model": lambda b, x: (b[0] + b[1] * x + b[2] * x**2 + b[3] * x**3) / (1 + b[4] * x + b[5] * x**2 + b[6] * x**3),
    "x": """
        -3.067 -2.981 -2.921 -2.912 -2.84 -2.797 -2.702 -2.699 -2.633 -2.481 -2.363 -2.322 -1.501 -1.46 -1.274
        -1.212 -1.1 -1.046 -0.915 -0.714 -0.566 -0.545 -0.4 -0.309 -0.109 -0.103 0.01 0.119 0.377 0.79 0.963
        1.006 1.115 1.572 1.841 2.047 2.2
    """,
    "y": """
        80.574 84.248 87.264 87.195 89.076 89.608 89.868 90.101 92.405 95.854 100.696 101.06 401.672 390.724
        567.534 635.316 733.054 759.087 894.206 990.785 1090.109 1080.914 1122.643 1178.351 1260.531 1273.514
        1288.339 1327.543 1353.863 1414.509 1425.208 1421.384 1442.962 1464.35 1468.705 1447.894 1457.628
    """,
    "starts": [[1000, 1000, 400, 40, 0.7, 0.3, 0.03], [1300, 1500, 500, 75, 1, 0.4, 0.05]],
    "bounds": [[0, 0, 0, 0, 0, 0, 0], [5000, 5000, 2000, 300, 3, 1, 0.3]],
    "certified": np.array(
        [1288.13968, 1491.0792535, 583.23836877, 75.416644291, 0.96629502864, 0.39797285797, 0.049727297349]
    ),
    "squares": 5.6427082397e03,
}
PROBLEMS = {"BoxBOD": BOXBOD, "Eckerle4": ECKERLE4, "Rat43": RAT43, "MGH10": MGH10, "Thurber": THURBER}


@pytest.mark.parametrize("start", [0, 1])
@pytest.mark.parametrize("name", PROBLEMS)
def test_the_certified_values_are_found(name, start):
    problem = PROBLEMS[name]
    x, y = (np.array(problem[name].split(), float) for name in "xy")

    def residual(b):
        step = 1e-30 * np.eye(len(b))  # complex: derivatives without rounding
        with np.errstate(over="ignore", invalid="ignore"):
            slopes = [problem["model"](b + 1j * one, x).imag / 1e-30 for one in step]
            return problem["model"](b, x) - y, np.stack(slopes, axis=1)

    bounds = np.array(problem["bounds"], float)
    rules = Rules(residual=1e-12, step=1e-12, iterations=3000)
    solution = minimise(residual, np.array(problem["starts"][start], float), tuple(bounds), rules)
    assert solution.status == "stationary"
    assert solution.x == pytest.approx(problem["certified"], rel=1e-6)
    assert solution.residual**2 == pytest.approx(problem["squares"], rel=1e-8)
