/* SPDX-License-Identifier: MIT */
/* Tests of the Web block. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/edit/edit.h"
#include "src/config/edit/print.h"
#include "src/config/read/load.h"
#include "tests/unit/aid/config_case.h"

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static void test_a_file_without_the_block_opens_no_door_and_lets_nobody_write(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item(ITEM));
	TEST_ASSERT_FALSE(config->web.given);
	TEST_ASSERT_EQUAL_UINT(0, config->web.address_count);
	TEST_ASSERT_FALSE(config->web.write);
	TEST_ASSERT_FALSE(config->web.configure);
	TEST_ASSERT_FALSE(config->web.has_proxy);
	TEST_ASSERT_NULL(config->web.files);
	TEST_ASSERT_NULL(config->web.hosts);
}

static void test_the_block_is_read_and_printed_so_that_it_reads_the_same(void)
{
	size_t len;
	char *text;
	FILE *out = open_memstream(&text, &len);

	TEST_ASSERT_NOT_NULL(out);
	TEST_ASSERT_EQUAL_INT(
		0,
		parse_driver("Web { Listen \"127.0.0.1:8080, [::1]:8081\" Write on Configure on\n"
	                     "Hosts \"a.example, b\" Proxy root Files \"/x\" }"));
	config_print(config, out);
	TEST_ASSERT_EQUAL_INT(0, fclose(out));
	config_free(config);
	config = NULL;
	TEST_ASSERT_EQUAL_INT(0, parse(text));
	free(text);
	TEST_ASSERT_TRUE(config->web.given && config->web.write && config->web.has_proxy);
	TEST_ASSERT_TRUE(config->web.configure);
	TEST_ASSERT_EQUAL_UINT(2, config->web.address_count);
	TEST_ASSERT_EQUAL_UINT(8081, config->web.addresses[1].port);
	TEST_ASSERT_TRUE(config->web.addresses[1].is_v6);
	TEST_ASSERT_EQUAL_UINT(0, config->web.proxy_uid);
	TEST_ASSERT_EQUAL_UINT(0, config->web.proxy_at.bits);
	TEST_ASSERT_EQUAL_STRING("a.example, b", config->web.hosts);
	TEST_ASSERT_EQUAL_STRING("/x", config->web.files);
	/* Listen of the driver is another */
	TEST_ASSERT_EQUAL_UINT(0, config->serve.address_count);
}

static void test_a_proxy_may_be_an_address(void)
{
	static const uint8_t other[] = {172, 30, 32, 3}, it[] = {172, 30, 32, 2};
	const struct config_web *web;

	TEST_ASSERT_EQUAL_INT(0, parse_driver("Web { Proxy \"172.30.32.2\" }"));
	web = &config->web;
	TEST_ASSERT_FALSE(web->has_proxy);
	TEST_ASSERT_TRUE(listen_peers_have(&web->proxy_at, 1, false, it));
	TEST_ASSERT_FALSE(listen_peers_have(&web->proxy_at, 1, false, other));
	config_free(config);
	config = NULL;
	TEST_ASSERT_EQUAL_INT(0, parse_driver("Web { Proxy \"fd00::1\" }"));
	TEST_ASSERT_EQUAL_UINT(128, config->web.proxy_at.bits);
}

static void test_what_cannot_be_is_an_error_at_its_place(void)
{
	static const struct line blocks[] = {
		{"Web { Listen \"house:8080\" }",
	         "f:2:14: error: Listen \"house:8080\": expected an address of this machine such as "
	         "192.168.1.5 (0.0.0.0 and [::]: all), or localhost\n"},
		{"Web { Listen \"8080, 8080\" }",
	         "f:2:14: error: Listen \"8080\": is given twice\n"},
		{"Web { Hosts \"a:80\" }",
	         "f:2:13: error: Hosts \"a:80\": expected names with commas between them, no "
	         "ports\n"},
		{"Web { Write maybe }", "f:2:13: error: Write \"maybe\": expected on or off\n"},
		{"Web { Proxy \"10.0.0.0/8\" }",
	         "f:2:13: error: Proxy \"10.0.0.0/8\": expected a user of this machine, or one "
	         "address\n"},
		{"Web { Proxy \"10.0.0\" }",
	         "f:2:13: error: Proxy \"10.0.0\": expected a user of this machine, or one "
	         "address\n"},
		{"Web { Files \"page\" }",
	         "f:2:13: error: Files \"page\": expected a path from the root, at most 255 bytes\n"},
		{"Web { } Web { }", "f:2:9: error: Web is given twice, first in line 2\n"},
	};

	expect_errors(blocks, COUNT(blocks), parse_driver);
}

static void test_what_may_be_a_slip_is_a_warning(void)
{
	static const struct line blocks[] = {
		{"Web { Proxy nobody-of-this-name }",
	         "f:2:13: warning: Proxy: there is no user nobody-of-this-name here\n"},
		{"Web { Host a }",
	         "f:2:7: warning: unknown key Host in Web is ignored; is it Hosts?\n"},
	};

	expect_warnings(blocks, COUNT(blocks), parse_driver);
}

static void test_an_edit_makes_the_block(void)
{
	static const char without[] = "OwsDrv {\n  Timeout 10 # s\n}\n";
	const char *setting = "Write=on";
	struct rio *rio;

	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", without, strlen(without), &report, &rio));
	TEST_ASSERT_EQUAL_INT(0, edit_set(&rio, "Web", &setting, 1, &report));
	TEST_ASSERT_EQUAL_STRING("OwsDrv {\n  Timeout 10 # s\n  Web {\n"
	                         "    Write                   on\n  }\n}\n",
	                         rio->text);
	rio_free(rio);
	TEST_ASSERT_EQUAL_STRING("", said);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_file_without_the_block_opens_no_door_and_lets_nobody_write);
	RUN_TEST(test_the_block_is_read_and_printed_so_that_it_reads_the_same);
	RUN_TEST(test_a_proxy_may_be_an_address);
	RUN_TEST(test_what_cannot_be_is_an_error_at_its_place);
	RUN_TEST(test_what_may_be_a_slip_is_a_warning);
	RUN_TEST(test_an_edit_makes_the_block);
	return UNITY_END();
}
