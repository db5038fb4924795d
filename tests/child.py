"""Programs that tests start beside them, and interrupt."""

import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def child(*command: str, **options) -> Iterator[subprocess.Popen]:
    """Run a program that Ctrl-C can reach, and that does not outlive its test.

    Whoever is started in the background ignores Ctrl-C, and so would its children.
    """

    def listen():
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, preexec_fn=listen, **pipes, **options) as process:
        try:
            yield process
        finally:
            process.kill()  # if it has not ended
