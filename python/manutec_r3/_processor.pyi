"""Which builds of the core the processor at hand can run. Private: see `processor`."""

builds: tuple[str, ...]
