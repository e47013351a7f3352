"""Run supervisord (https://supervisord.org) under the name by which its processes know whom to end with.

`python -m mart.platform.run.supervisord OPTION …` takes supervisord's own options.
"""

from __future__ import annotations

import os
import sys

from supervisor.supervisord import main

from mart.runtime.supervision import SUPERVISOR_PID

if __name__ == "__main__":
    os.environ[SUPERVISOR_PID] = str(os.getpid())
    main(sys.argv[1:])
