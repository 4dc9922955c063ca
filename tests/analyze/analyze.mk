# SPDX-License-Identifier: MIT
# What looks at the source and at the tests

.PHONY: analyze

# gcc -fanalyzer, clang-tidy and cppcheck, two to four minutes; TOOLS and FILES narrow it
analyze:
	@sh board/install-deps build analyze $(if $(OR_SKIP),|| true)
	@python3 tests/analyze/run $(if $(OR_SKIP),--or-skip) $(TOOLS:%=--tool %) $(FILES:%=--file %) \
	    -- $(CC) $(ALL_CFLAGS)
