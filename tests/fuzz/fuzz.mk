# SPDX-License-Identifier: MIT
# Fuzzing: each target is one file tests/fuzz/fuzz_*.c, linked twice: with clang's libFuzzer and the
# address and undefined-behaviour sanitizers for make fuzz, and with replay.c for make unit, which
# runs its seeds and found cases.
#   FUZZ picks targets, FUZZ_SECONDS bounds each of them, FUZZ_JOBS run at once; with FUZZ_SEED other
#   than 0 the same inputs are tried each time, as many as the machine does (of w1 and netlink the
#   first thousands are the same); FUZZ_CC is another clang; OR_SKIP=1 counts the targets as skipped
#   where there is no libFuzzer.

FUZZ_TARGETS := $(filter-out $(if $(PROTOBUFC),,sparkplug),$(patsubst tests/fuzz/fuzz_%.c,%,$(wildcard tests/fuzz/fuzz_*.c)))
FUZZ         ?= $(FUZZ_TARGETS)
FUZZ_SECONDS ?= 60
FUZZ_JOBS    ?= $(shell nproc)
FUZZ_SEED    ?= 0
FUZZ_CC      ?= $(CCACHE)clang
FUZZ_BUILD   := build/fuzz/programs
REPLAYS      := $(FUZZ_TARGETS:%=$(B)/fuzz/replay_%)

# What a target needs beside core.a, the functions of which it takes the place (__wrap_...), and
# where its dictionary comes from: the words in quotes of these files
FUZZ_WITH_owserver := fuzz/bus_host.o
FUZZ_WITH_controller    := tests/unit/aid/giving.o $(patsubst %.c,%.o,$(wildcard tests/unit/aid/scene*.c))
FUZZ_WITH_image    := fuzz/heap_instance.o fuzz/heap_map.o fuzz/heap_give.o
FUZZ_WITH_serve    := fuzz/heap_instance.o fuzz/heap_map.o fuzz/heap_give.o
FUZZ_WITH_w1       := fuzz/bus_host.o fuzz/sysfs.o
FUZZ_WITH_netlink  := fuzz/bus_host.o fuzz/sysfs.o
FUZZ_WITH_scenario := fuzz/bus_host.o $(SIM_TABLE:%.c=%.o)
FUZZ_WITH_trace    := fuzz/bus_host.o $(SIM_TABLE:%.c=%.o)
FUZZ_WORDS_trace   := hal/trace/trace.c hal/trace/lines.c hal/trace/links.c hal/trace/i2c.c
FUZZ_WORDS_scenario := $(wildcard hal/sim/*.c hal/sim/chips/*.c)
FUZZ_WITH_owsctl   := fuzz/heap_instance.o fuzz/heap_map.o fuzz/heap_give.o fuzz/json_valid.o
FUZZ_WITH_sparkplug := fuzz/heap_instance.o fuzz/heap_map.o fuzz/heap_give.o
$(B)/fuzz/sparkplug $(B)/fuzz/replay_sparkplug: LIBS += -lprotobuf-c
# w1 and netlink have a property that is the process's number
FUZZ_WRAP_w1       := getpid
FUZZ_WRAP_netlink  := getpid
FUZZ_WRAP_owsctl   := getpid clock_gettime time exit ows_now segment_wait nanosleep \
                      ctl_reader_gone terminal_catch_signals isatty ows_open ows_open_as open_in \
                      ows_close board_look replace_file replace_lock replace_unlock rio_read bus_create
FUZZ_WORDS_owsctl  := src/tool/owsctl/owsctl.c src/ground/signal/attribute.c src/config/read/options.c src/tool/owsctl/watch/condition.c
FUZZ_WORDS_values  := src/ground/signal/attribute.c src/ground/signal/value.c hal/owfs/path.c src/config/read/listen.c
FUZZ_WORDS_web     := src/faces/web/head.c src/faces/kit/body.c src/faces/web/origin.c src/faces/web/command.c
FUZZ_WORDS_sparkplug := tests/fuzz/heap_instance.c src/faces/mqtt/sparkplug.c
FUZZ_WORDS_writer  := src/faces/writer/order.c
FUZZ_WORDS_rio     := src/config/read/options.c src/config/read/targets.c src/ground/signal/value.c hal/native/native.c
FUZZ_WORDS_serve   := src/daemon/serve/node.c src/daemon/serve/directory.c src/ground/signal/attribute.c hal/owfs/path.c

.PHONY: fuzz replays

# Debian's clang only recommends libFuzzer's runtime
FUZZ_HAS = echo 'int LLVMFuzzerTestOneInput(void); int LLVMFuzzerTestOneInput(void) { return 0; }' | \
    $(FUZZ_CC) -fsanitize=fuzzer,address -x c -o /dev/null - 2>/dev/null

fuzz:
	@$(FUZZ_HAS) || sh board/install-deps fuzz $(if $(OR_SKIP),|| true)
	@$(FUZZ_HAS) || { \
	    echo "fuzz: $(FUZZ_CC) cannot link -fsanitize=fuzzer here (package libclang-rt-dev, or libclang-rt-NN-dev of clang-NN)"; \
	    $(if $(OR_SKIP),,exit 1;) }
	@if $(FUZZ_HAS); then \
	    $(MAKE) --no-print-directory B=$(FUZZ_BUILD) CC='$(FUZZ_CC)' CFLAGS='-O1 -g' \
	        HARDEN='-U_FORTIFY_SOURCE -fPIE' EXTRA_CFLAGS='-fsanitize=fuzzer-no-link,address,undefined \
	        -fno-sanitize-recover=all -fno-omit-frame-pointer' \
	        $(FUZZ:%=$(FUZZ_BUILD)/fuzz/%) $(FUZZ:%=$(FUZZ_BUILD)/fuzz/%.dict) && \
	    python3 tests/fuzz/run --seconds $(FUZZ_SECONDS) --jobs $(FUZZ_JOBS) --seed $(FUZZ_SEED) \
	        --programs $(FUZZ_BUILD)/fuzz $(FUZZ); \
	else \
	    echo '0 passed, 0 failed, $(words $(FUZZ)) skipped'; \
	fi

replays: $(REPLAYS)

$(B)/fuzz/%.o: tests/fuzz/%.c $(UNITY)/unity.h $(B)/with/cc
	$(call compile,$(UNITY_FLAGS))

define fuzz_program
$$(B)/fuzz/$(1): $$(B)/fuzz/fuzz_$(1).o $$(B)/fuzz/fuzz.o $$(FUZZ_WITH_$(1):%=$$(B)/%) $$(B)/unit/unity.o \
    $$(B)/core.a $$(B)/with/ld
	$$(call link,-fsanitize=fuzzer $$(FUZZ_WRAP_$(1):%=-Wl$$(comma)--wrap=%))

$$(B)/fuzz/replay_$(1): $$(B)/fuzz/fuzz_$(1).o $$(B)/fuzz/fuzz.o $$(B)/fuzz/replay.o \
    $$(FUZZ_WITH_$(1):%=$$(B)/%) $$(B)/unit/unity.o $$(B)/core.a $$(B)/with/ld
	$$(call link,$$(FUZZ_WRAP_$(1):%=-Wl$$(comma)--wrap=%))

$$(B)/fuzz/$(1).dict: $$(FUZZ_WORDS_$(1)) tests/fuzz/fuzz.mk
	@mkdir -p $$(@D)
	@cat /dev/null $$(FUZZ_WORDS_$(1)) | grep -o '"[A-Za-z0-9_./=-]\{2,24\}"' | sort -u >$$@ || true
endef
$(foreach t,$(FUZZ_TARGETS),$(eval $(call fuzz_program,$(t))))
