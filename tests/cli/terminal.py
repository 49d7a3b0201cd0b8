#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a command on a terminal of its own, and writes what it shows there, with LF for CR LF.

usage: terminal.py COLUMNS COMMAND...; COLUMNS 0 is a terminal that does not know its size. Ends as COMMAND does."""

import fcntl
import os
import pty
import struct
import sys
import termios

child, terminal = pty.fork()
if child == 0:
    fcntl.ioctl(1, termios.TIOCSWINSZ, struct.pack("HHHH", 0, int(sys.argv[1]), 0, 0))
    os.execvp(sys.argv[2], sys.argv[2:])
shown = b""
while True:
    try:
        more = os.read(terminal, 65536)
    except OSError:  # EIO: the command has ended
        break
    if not more:
        break
    shown += more
sys.stdout.buffer.write(shown.replace(b"\r\n", b"\n"))
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
