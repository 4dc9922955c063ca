#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints what changes, in an asyncio loop that has other things to do: no thread, no polling.

    python3 follow.py [INSTANCE]
"""

import asyncio
import sys

import ows


async def changes(signals):
    """The names of signals that change, as they come; over restarts and reloads of owsd, too."""
    loop, look, news = asyncio.get_running_loop(), signals.changes(0), asyncio.Event()
    while True:
        fd = signals.fileno()  # before the look: what comes after it makes it readable
        try:
            if names := next(look):
                yield names
                continue
        except ows.Stale:
            try:
                signals.reopen()
                continue
            except OSError:  # the next one is not there yet
                pass
        news.clear()
        loop.add_reader(fd, news.set)
        await news.wait()  # at most for half a second
        loop.remove_reader(fd)


async def follow(instance):
    with ows.Ows(instance) as signals:
        async for names in changes(signals):
            for name in names:
                print(name, signals[name], flush=True)


try:
    asyncio.run(follow(sys.argv[1] if len(sys.argv) > 1 else "OWS"))
except ows.NotRunning as e:
    sys.exit(str(e))
except KeyboardInterrupt:
    pass
