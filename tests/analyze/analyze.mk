# SPDX-License-Identifier: MIT
# What looks at the source and at the tests: other compilers and sanitizers, analyzers, coverage

.PHONY: analyze coverage lint format syntax clang sanitize asan tsan m32 m32-syntax

# What gcc guesses of values is worse in code that a sanitizer has changed; the plain build is asked
GUESSES  := -Wno-maybe-uninitialized -Wno-format-truncation
ASAN_FLAGS := -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer \
              $(GUESSES)
# TSan does not know fences, and gcc says so at each
TSAN_FLAGS := -fsanitize=thread -fno-omit-frame-pointer -Wno-tsan $(GUESSES)

# Lines are all that a sanitizer names of what -g knows
asan:
	@$(MAKE) --no-print-directory B=build/asan all
	@ASAN_OPTIONS=detect_leaks=1:abort_on_error=0:handle_sigbus=0 UBSAN_OPTIONS=print_stacktrace=1 \
	    sh tests/both $(MAKE) --no-print-directory B=build/asan
asan: export EXTRA_CFLAGS := $(ASAN_FLAGS)
asan: export CFLAGS := -O1 -g1

# Without the address space's randomness: some kernels give more of it than TSan can stand
tsan:
	@$(MAKE) --no-print-directory B=build/tsan all
	@fixed=; setarch -R true 2>/dev/null && fixed='setarch -R'; \
	    TSAN_OPTIONS=halt_on_error=1:handle_sigbus=0:suppressions=$(CURDIR)/tests/tsan.supp \
	    LIMIT=$${LIMIT:-900} $$fixed sh tests/both $(MAKE) --no-print-directory B=build/tsan
tsan: export EXTRA_CFLAGS := $(TSAN_FLAGS)
tsan: export CFLAGS := -O1 -g1

sanitize:
	@$(MAKE) --no-print-directory asan
	@$(MAKE) --no-print-directory tsan

# All C as a compiler reads it, which makes no code of it: make syntax CC=clang WERROR=1. The model and
# what is preloaded have flags of their own
SYNTAX := $(sort $(CORE) $(wildcard $(foreach p,daemon/owsd/owsd tool/owsctl/owsctl history/recorder/recorder faces/writer/owsd_writer,\
          src/$p.c) $(filter-out tests/model/%,$(wildcard docs/examples/*.c tests/*/*.c tests/unit/*/*.c))))
SYNTAX_FLAGS := $(UNITY_FLAGS) -Isrc/public $(PROTO_FLAGS) -fsyntax-only
syntax: $(UNITY)/unity.h $(PROTO:%=%.h)
	@printf '%s\n' $(SYNTAX) | xargs -P $$(nproc) -n 16 $(CC) $(ALL_CFLAGS) $(SYNTAX_FLAGS)
	@$(if $(filter -m32,$(EXTRA_CFLAGS)),,$(CXX) $(ALL_CXXFLAGS) $(SYNTAX_FLAGS) $(filter %.cpp,$(EXAMPLES)))
	@echo '$(words $(SYNTAX)) passed, 0 failed'

clang:
	@$(MAKE) --no-print-directory B=build/clang CC='$(CCACHE)clang' CXX='$(CCACHE)clang++' WERROR=1 \
	    all examples unit

# 32 bits with 64-bit time: what breaks here breaks on a Raspberry Pi with a 32-bit system. Floats
# as there: SSE, because the x87 evaluates them in more bits than they have.
m32:
	@if echo 'int main(void) { return 0; }' | $(CC) -m32 -x c -o /dev/null - 2>/dev/null; then \
	    $(MAKE) --no-print-directory B=build/m32 all unit; \
	else \
	    echo "m32: $(CC) cannot link 32-bit programs here (package gcc-12-multilib)"; \
	    echo '0 passed, 0 failed, 1 skipped'; \
	fi
# The layout's assertions and all types of 32 bits, without running anything
m32-syntax:
	@if echo '#include <stdint.h>' | $(CC) -D_FILE_OFFSET_BITS=64 $(EXTRA_CFLAGS) -x c -fsyntax-only - 2>/dev/null; then \
	    $(MAKE) --no-print-directory syntax; \
	else \
	    echo "m32-syntax: $(CC) has no headers for 32 bits here (package gcc-12-multilib)"; \
	    echo '0 passed, 0 failed, 1 skipped'; \
	fi
# The headers of the kernel are those of this machine; gcc-multilib would link them for -m32
m32 m32-syntax: export EXTRA_CFLAGS := -m32 -msse2 -mfpmath=sse -D_TIME_BITS=64 \
            -idirafter /usr/include/$(shell $(CC) -print-multiarch 2>/dev/null)

# The form of all files, and what a program can mend of it
lint:
	@sh board/install-deps lint $(if $(OR_SKIP),|| true)
	@python3 tests/lint/run
format:
	@python3 tests/lint/run --mend

# gcc -fanalyzer, clang-tidy and cppcheck, a quarter of an hour; TOOLS and FILES narrow
# it. What was clean and has not changed is not read again; OWSD_ANALYZE_ALL=1 reads all
analyze: $(PROTO:%=%.h)
	@sh board/install-deps build analyze $(if $(OR_SKIP),|| true)
	@python3 tests/analyze/run $(if $(OR_SKIP),--or-skip) $(TOOLS:%=--tool %) $(FILES:%=--file %) \
	    -- $(CC) $(ALL_CFLAGS) $(PROTO_FLAGS)

# Which lines and branches of src and hal the unit and system tests reach (COVER=unit: those alone),
# some minutes. What is killed, as some tests do with owsd, has counted nothing. The libraries are
# those found here, as a compiler that is asked with --coverage leaves files behind
COVER_FLOOR ?= 86
COVER_MAKE = $(MAKE) --no-print-directory B=build/coverage LIBI2C='$(LIBI2C)' LIBGPIOD='$(LIBGPIOD)'
coverage:
	@sh board/install-deps build run test coverage
	@find build/coverage -name '*.gcda' -delete 2>/dev/null || true
	@$(COVER_MAKE) all
	@sh tests/analyze/sum $(if $(COVER),$(COVER_MAKE) $(COVER),sh tests/both $(COVER_MAKE)) -- \
	    python3 tests/analyze/coverage build/coverage $(if $(COVER),,--floor $(COVER_FLOOR))
coverage: export CFLAGS := -O0 -g
coverage: export EXTRA_CFLAGS := --coverage -fprofile-update=atomic
coverage: export GCOV_ERROR_FILE := /dev/null
