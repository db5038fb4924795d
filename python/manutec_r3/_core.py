"""The compiled core, in the build for the processor at hand. `_core.pyi` tells what is in it.

All others import the core from here.
"""

from .processor import chosen as _chosen

if _chosen() == "x86-64-v3":
    from ._core_x86_64_v3 import *  # noqa: F403
else:
    from ._core_baseline import *  # noqa: F403
