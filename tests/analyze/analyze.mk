# SPDX-License-Identifier: MIT
# What looks at the source and at the tests

.PHONY: analyze coverage format

# Lays all C out as .clang-format says; analyze checks it
format:
	@git ls-files '*.c' '*.h' | grep -E '^(src|hal|tests)/' | xargs clang-format -i

# clang-format, gcc -fanalyzer, clang-tidy and cppcheck, two to four minutes; TOOLS and FILES narrow it
analyze:
	@sh board/install-deps build analyze $(if $(OR_SKIP),|| true)
	@python3 tests/analyze/run $(if $(OR_SKIP),--or-skip) $(TOOLS:%=--tool %) $(FILES:%=--file %) \
	    -- $(CC) $(ALL_CFLAGS)

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
