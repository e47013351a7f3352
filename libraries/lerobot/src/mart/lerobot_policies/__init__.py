"""Let policies that LeRobot trained drive arms of MART and be evaluated: `mart operate` and `mart eval` load them.

It needs LeRobot in the same environment only where a policy is loaded.
"""
