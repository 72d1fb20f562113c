"""Scene files as text, for the tests of what reads and runs them."""

START = """
[start]
gamma = ["0.48", "0.6", "0.64"]
M = ["0.384", "1.28", "-1.488"]
"""
BALL = f"""
title = "A short run"
system = "chaplygin_ball"
[body]
inertia = ["1", "2", "3"]
d = "0.7"
{START}
[run]
times = [0, 1, 2.5]
"""
TOP = BALL.replace("chaplygin_ball", "euler_top").replace('d = "0.7"\n', "").replace("[0, 1, 2.5]", "[1, 2.5, 4]")
REPORT = """
[report]
digits = [15]
tolerances = ["1e-6"]
truth_digits = 30
check_time = "0.25"
repeat = 1
[output]
pictures = ["sphere", "work_precision"]
sphere = { until = 5, count = 50 }
"""
# numbers in every form, and no title
MIXED = """
system = "chaplygin_ball"
[body]
inertia = ["1", 2, 3.0]
d = "0.7"
[start]
gamma = ["0.48", "0.6", 0.64]
M = ["0.384", "1.28", "-1.488"]
[run]
times = [0, 0.1, "1/3"]
"""
TILDE = f"""
system = "tilde"
[body]
inertia = [1, 2, 4]
d = "0.7"
potential = ["0.1", "0.05", "0.02", "0.04", "0.06"]
{START}
[run]
times = [0, "0.25"]
"""
ORBIT = f"""
system = "chaplygin_ball"
[body]
inertia = [1, 2, 3]
d = 1
{START}
[steps]
maps = [{{ kind = "translation", points = [34, 27], multiple = 2 }}]
count = 12
"""
EXACT = ORBIT.replace("[body]", 'field = "GF(2^61-1)"\n[body]', 1)
