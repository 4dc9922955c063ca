/* SPDX-License-Identifier: MIT */
/* Parses .rio documents from texts. */
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/rio_case.h"

struct rio *rio;

void rio_case_begin(void)
{
	said_begin();
	rio = NULL;
}

void rio_case_end(void)
{
	rio_free(rio);
}

struct rio_node *rio_case_parse(const char *text)
{
	rio_free(rio);
	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", text, strlen(text), &report, &rio));
	TEST_ASSERT_EQUAL_STRING("", said);
	return &rio->root;
}

void rio_case_expect(const struct rio_node *block, const char *key, enum rio_kind kind,
                     const char *value)
{
	const struct rio_node *node = rio_child(block, key);

	TEST_ASSERT_NOT_NULL_MESSAGE(node, key);
	TEST_ASSERT_EQUAL_INT_MESSAGE(kind, node->kind, key);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(value, node->value, key);
}
