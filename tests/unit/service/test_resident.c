/* SPDX-License-Identifier: MIT */
/* The start's pages are given back, and the program goes on with what it had. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/service/resident.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static long kib_of(const char *field)
{
	FILE *status = fopen("/proc/self/status", "r");
	char line[128];
	long kib = -1;

	TEST_ASSERT_NOT_NULL(status);
	while (kib < 0 && fgets(line, sizeof(line), status))
		if (strncmp(line, field, strlen(field)) == 0)
			kib = atol(line + strlen(field));
	fclose(status);
	return kib;
}

static int written = 1;
static const char *const relocated[] = {"one", "two"};

static void test_pages_of_files_are_given_back(void)
{
	long before = kib_of("RssFile:");

	resident_drop_start();
	TEST_ASSERT_LESS_THAN(before, kib_of("RssFile:"));
}

/* As a debugger and the kernel's probes do: a page of code that is no more that of the file. */
static void test_a_page_that_differs_from_its_file_stays(void)
{
	long page = sysconf(_SC_PAGESIZE);
	char path[] = "/tmp/owsd-test-resident-XXXXXX";
	int fd = mkstemp(path);
	char *code;

	TEST_ASSERT_EQUAL(0, ftruncate(fd, page));
	code = mmap(NULL, (size_t)page, PROT_READ | PROT_WRITE, MAP_PRIVATE, fd, 0);
	TEST_ASSERT_TRUE(code != MAP_FAILED);
	code[0] = 'x';
	TEST_ASSERT_EQUAL(0, mprotect(code, (size_t)page, PROT_READ));
	resident_drop_start();
	TEST_ASSERT_EQUAL('x', code[0]);
	munmap(code, (size_t)page);
	close(fd);
	unlink(path);
}

static void test_what_was_written_stays(void)
{
	char *volatile heap = strdup("heap");

	written = 2;
	resident_drop_start();
	TEST_ASSERT_EQUAL(2, written);
	TEST_ASSERT_EQUAL_STRING("two", relocated[1]);
	TEST_ASSERT_EQUAL_STRING("heap", heap);
	free(heap);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_pages_of_files_are_given_back);
	RUN_TEST(test_a_page_that_differs_from_its_file_stays);
	RUN_TEST(test_what_was_written_stays);
	return UNITY_END();
}
