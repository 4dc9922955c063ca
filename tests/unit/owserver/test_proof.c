/* SPDX-License-Identifier: MIT */
/* What owserver 3.2p4 reads as ones of a chip that was pulled out while another stayed. */
#include "unity.h"

#include "hal/owserver/judge.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_what_was_read_as_ones_of_nobody_needs_a_proof(void)
{
	static const char *const paths[] = {"/10.67C6697351FF/errata/die",
	                                    "/22.67C6697351FF/errata/trim",
	                                    "/28.67C6697351FF/errata/trimvalid",
	                                    "/28.67C6697351FF/power",
	                                    "/42.67C6697351FF/power",
	                                    "/uncached/3B.67C6697351FF/power",
	                                    "/3B.67C6697351FF/memory",
	                                    "/3B.67C6697351FF/pages/page.2",
	                                    "/12.67C6697351FF/memory",
	                                    "/12.67C6697351FF/pages/page.ALL",
	                                    "/26.67C6697351FF/S3-R1-A/gain",
	                                    "/30.67C6697351FF/volt",
	                                    "/kitchen/temperature"};

	for (unsigned i = 0; i < sizeof(paths) / sizeof(*paths); i++)
		TEST_ASSERT_TRUE_MESSAGE(proof_is_needed(paths[i]), paths[i]);
}

static void test_what_was_an_error_needs_none(void)
{
	static const char *const paths[] = {
		"/28.67C6697351FF/temperature",  "/3B.67C6697351FF/temperature12",
		"/3B.67C6697351FF/scratchpad",   "/12.67C6697351FF/sensed.BYTE",
		"/26.67C6697351FF/pages/page.0", "/1D.67C6697351FF/memory",
		"/20.67C6697351FF/volt.A",       "/26.67C6697351FF/S3-R1-A/current",
		"/30.67C6697351FF/present",      "/3B.67C6697351FF/present",
		"/settings/timeout/volatile"};

	for (unsigned i = 0; i < sizeof(paths) / sizeof(*paths); i++)
		TEST_ASSERT_FALSE_MESSAGE(proof_is_needed(paths[i]), paths[i]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_was_read_as_ones_of_nobody_needs_a_proof);
	RUN_TEST(test_what_was_an_error_needs_none);
	return UNITY_END();
}
