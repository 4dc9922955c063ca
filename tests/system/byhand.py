# SPDX-License-Identifier: MIT
"""A program that commands without libows, by the layout alone: it may do what libows does not."""

import mmap
import os
import socket
import struct

import owsdtest

HELLO_MAGIC, MAJOR = 0x4853574F, 2
SLOT_OFF, DIRTY_OFF, MARKED = 24, 48, 128
# Words of a slot
STAMP, WRITE_ENABLE, ONE_SHOT = 2, 5, 6


class Controller:
    def __init__(self, name):
        self.door = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.door.connect(str(owsdtest.segment(name, "control")))
        self.door.send(struct.pack("<IHHII16s32s64x", HELLO_MAGIC, MAJOR, 0, 1, 0, b"", b"by hand"))
        _, (self.fd, self.bell, self.news), _, _ = socket.recv_fds(self.door, 64, 3)
        self.memory = mmap.mmap(self.fd, 0)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.door.close()
        for fd in (self.fd, self.bell, self.news):
            os.close(fd)

    def ring(self):
        os.write(self.bell, struct.pack("<Q", 1))

    def scribble(self, rng):
        """Rubbish somewhere, and the bell."""
        at = rng.randrange(0, len(self.memory), 4)
        data = rng.randbytes(min(rng.choice([1, 4, 64, 1024, 4096]), len(self.memory) - at))
        self.memory[at:at + len(data)] = data
        self.ring()

    def command(self, record, words, value=None):
        """Words of the slot of a record by their numbers."""
        slot_off, dirty_off = (struct.unpack_from("<I", self.memory, at)[0]
                               for at in (SLOT_OFF, DIRTY_OFF))
        slot = slot_off + 64 * record
        if value is not None:
            struct.pack_into("<q", self.memory, slot, value)
        for number, word in words.items():
            struct.pack_into("<I", self.memory, slot + 4 * number, word)
        struct.pack_into("<I", self.memory, dirty_off + record // 32 * 4, 1 << record % 32)
        struct.pack_into("<I", self.memory, MARKED, 1)
        self.ring()
