# SPDX-License-Identifier: MIT
# An image made with pi-gen's stage, in QEMU: the CASES: main (two boots), bare, full.
# IMAGE_TIME bounds a boot, in seconds; OR_SKIP=1 counts as skipped what cannot run here.

.PHONY: test-image

IMAGE_SIMCHIP := $(ARM64_PLAIN)/kernel/simchip
IMAGE_TIME ?= 900

test-image: CASES ?= main bare full
test-image:
	@sh board/install-deps build arm64 image $(if $(OR_SKIP),|| true)
	@$(ARM64_PLAIN_MAKE) $(IMAGE_SIMCHIP) $(if $(OR_SKIP),|| true)
	@python3 tests/image/boot --time $(IMAGE_TIME) $(if $(OR_SKIP),--or-skip) --debs build/deb \
	    --build build/image --program $(IMAGE_SIMCHIP) --cc '$(ARM64_CC)' $(CASES)
