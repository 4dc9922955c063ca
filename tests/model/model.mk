# SPDX-License-Identifier: MIT
# That the shared memory is right: a model of it, its writer killed, readers as arm64 code.

.PHONY: model test-kill hammer-arm64

# The writer of the shared memory killed at random points: KILLS=10000, about a minute
test-kill: export KILLS := $(or $(KILLS),10000)
test-kill: all $(B)/unit/test_kill
	@$(B)/unit/test_kill | tee $(B)/test-kill.log
	@awk '/ Tests .* Failures /{ print $$1 - $$3, "passed,", $$3, "failed"; bad = $$3; n = 1 } END { exit bad || !n }' $(B)/test-kill.log

# Readers beside a writer as arm64 code, in qemu's user mode: a few seconds beside the building
hammer-arm64:
	@sh board/install-deps build hammer $(if $(OR_SKIP),|| true)
	@+if command -v qemu-aarch64-static >/dev/null && \
	    echo 'int main(void) { return 0; }' | $(ARM64_CC) -x c -o /dev/null - 2>/dev/null; then \
	    $(ARM64_PLAIN_MAKE) $(ARM64_PLAIN)/unit/test_torn && \
	    RUNNER='qemu-aarch64-static -L /usr/aarch64-linux-gnu' sh tests/unit/run $(ARM64_PLAIN)/unit/test_torn; \
	else \
	    echo 'hammer-arm64: no compiler for arm64, or no qemu-aarch64-static'; \
	    $(if $(OR_SKIP),echo '0 passed$(comma) 0 failed$(comma) 1 skipped',exit 1); \
	fi

# The same sources, with each access to shared memory a step of the model: within a minute
MODEL     := $(wildcard tests/model/*.c)
MODEL_CODE := src/memory/shm/image.c src/memory/shm/entries.c src/memory/shm/reader.c src/memory/shm/controller.c src/daemon/host/bells.c \
             src/memory/control/control.c src/memory/control/news.c src/memory/libows/alive.c src/memory/libows/changes.c src/memory/libows/get.c \
             src/memory/libows/set.c src/memory/libows/give.c src/memory/libows/command.c src/memory/libows/wait.c \
             src/memory/libows/news.c src/memory/libows/alarm.c src/memory/libows/origin.c
# What runs as a thread of the model, beside that; all else here is the model itself
MODEL_RUN := tests/model/changes.c tests/model/litmus.c tests/model/orders.c tests/model/records.c

$(B)/model/%.o: %.c tests/model/access.h $(B)/with/cc
	$(call compile,$(if $(filter $<,$(MODEL_RUN) $(MODEL_CODE)),-include tests/model/access.h))

$(B)/model/model: $(patsubst %.c,$(B)/model/%.o,$(MODEL) $(MODEL_CODE)) $(B)/core.a $(B)/with/ld
	$(call link,-Wl$(comma)--wrap=write -Wl$(comma)--wrap=send -Wl$(comma)--wrap=read -Wl$(comma)--wrap=ppoll \
	    -Wl$(comma)--wrap=syscall -Wl$(comma)--wrap=ows_now -Wl$(comma)--wrap=nanosleep)

model: all $(B)/model/model
	@$(B)/model/model
