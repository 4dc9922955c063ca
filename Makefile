# SPDX-License-Identifier: MIT
# owsd: the makefile is the map of the program. Everything is built in $(B).

VERSION  := 0.1.0
B        ?= build
PREFIX   ?= /usr/local
DESTDIR  ?=

CC       := $(CROSS_COMPILE)$(if $(filter default,$(origin CC)),gcc,$(CC))
CXX      := $(CROSS_COMPILE)$(if $(filter default,$(origin CXX)),g++,$(CXX))
AR       := $(CROSS_COMPILE)$(if $(filter default,$(origin AR)),ar,$(AR))
PKG_CONFIG ?= pkg-config

WARN     := -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes \
            -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef -Wvla -Wformat=2 \
            -Wno-missing-field-initializers
HARDEN   := -fstack-protector-strong -D_FORTIFY_SOURCE=2 -fPIE
CFLAGS   ?= -O2 -g
EXTRA_CFLAGS ?=
ALL_CFLAGS = -std=c17 -D_GNU_SOURCE -D_FILE_OFFSET_BITS=64 -I. -DOWSD_VERSION='"$(VERSION)"' \
             $(WARN) $(HARDEN) $(CFLAGS) $(EXTRA_CFLAGS)
ALL_LDFLAGS = -pie -Wl,-z,relro,-z,now $(LDFLAGS) $(EXTRA_CFLAGS)
LIBS     := -lm -pthread

# --- The roles -------------------------------------------------------------------------------
# What a value is, and the names of section 3.3
SIGNAL   := $(wildcard src/signal/*.c)
# The .rio file
CONFIG   := $(wildcard src/config/*.c)
# Shared memory, owsd's side
SHM      := $(wildcard src/shm/*.c)
# The signal table and its lanes: no I/O in here
ENGINE   := $(wildcard src/engine/*.c)
# Ways to a device: the contract, its host, and one folder for each backend
HAL      := $(wildcard hal/*.c) $(wildcard hal/*/*.c)
# The programs and the consumers' library
OWSD     := $(wildcard src/*.c)
LIBOWS   := $(wildcard src/libows/*.c)
OWSCTL   := $(wildcard src/owsctl/*.c)
# ---------------------------------------------------------------------------------------------

CORE     := $(SIGNAL) $(CONFIG) $(SHM) $(ENGINE) $(HAL) $(LIBOWS) $(filter-out src/owsd.c,$(OWSD))
obj       = $(patsubst %.c,$(B)/%.o,$(1))
UNIT     := $(patsubst tests/unit/%.c,$(B)/unit/%,$(wildcard tests/unit/test_*.c))

.PHONY: all unit clean
all:

$(B)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

# Everything but main(): what the unit tests link
$(B)/core.a: $(call obj,$(CORE))
	@rm -f $@
	$(AR) rcs $@ $^

-include $(shell find $(B) -name '*.d' 2>/dev/null)

clean:
	rm -rf $(B)
