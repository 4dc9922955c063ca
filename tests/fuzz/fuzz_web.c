/* SPDX-License-Identifier: MIT */
/*
 * What a browser sends to owsd-web: the first byte picks the head of a request, the body of a
 * command, or the headers Host and Origin. A head has one verdict, whatever comes behind it; a body
 * that was read and is printed is read as the same.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/kit/body.h"
#include "src/faces/show/json.h"
#include "src/faces/web/head.h"
#include "src/faces/web/origin.h"
#include "src/ground/signal/utf8.h"
#include "tests/fuzz/fuzz.h"

size_t fuzz_memory(size_t n)
{
	return 60000 + 16 * n;
}

static void check_head(const char *text, size_t n)
{
	const char *why;
	int verdict = head_check(text, n, &why);

	TEST_ASSERT_NOT_NULL(why);
	TEST_ASSERT_TRUE(verdict == 0 || verdict == 200 || (verdict >= 400 && *why));
	TEST_ASSERT_TRUE(verdict != 0 || n < HEAD_MAX);
	for (size_t len = n > 300 ? n - 300 : 0; len < n; len++) {
		int before = head_check(text, len, &why);

		TEST_ASSERT_TRUE_MESSAGE(before == 0 || before == verdict, "another verdict");
	}
	if (verdict != 200)
		return;
	TEST_ASSERT_TRUE(memmem(text, n, "\r\n\r\n", 4) != NULL);
	TEST_ASSERT_NULL(memmem(text, (size_t)((const char *)memmem(text, n, "\r\n\r\n", 4) - text),
	                        "\r\n ", 3));
}

static void print(const struct body *body, FILE *out)
{
	struct json json;

	json_open(&json, out);
	json_object(&json, NULL);
	for (unsigned i = 0; i < body->count; i++) {
		const struct body_member *member = &body->members[i];

		switch (member->kind) {
		case BODY_NULL:
			json_null(&json, member->key);
			break;
		case BODY_STRING:
			json_string(&json, member->key, member->text);
			break;
		case BODY_NUMBER:
			json_number(&json, member->key, member->text);
			break;
		case BODY_TRUE:
		case BODY_FALSE:
			json_bool(&json, member->key, member->kind == BODY_TRUE);
			break;
		}
	}
	json_object_end(&json);
}

static void check_body(const char *text, size_t n)
{
	static struct body body, again;
	char *bytes = malloc(n ? n : 1), *printed = NULL;
	size_t len = 0;
	FILE *out;
	int err;

	TEST_ASSERT_NOT_NULL(bytes);
	memcpy(bytes, text, n);
	err = body_parse(bytes, n, &body);
	TEST_ASSERT_TRUE(err == 0 || err == -EINVAL || err == -E2BIG);
	if (err) {
		free(bytes);
		return;
	}
	out = open_memstream(&printed, &len);
	TEST_ASSERT_NOT_NULL(out);
	print(&body, out);
	fclose(out);
	TEST_ASSERT_EQUAL_INT(0, body_parse(printed, len, &again));
	TEST_ASSERT_EQUAL_UINT(body.count, again.count);
	for (unsigned i = 0; i < body.count; i++) {
		TEST_ASSERT_EQUAL_INT(body.members[i].kind, again.members[i].kind);
		TEST_ASSERT_EQUAL_STRING(body.members[i].key, again.members[i].key);
		TEST_ASSERT_EQUAL_STRING(body.members[i].text, again.members[i].text);
	}
	free(printed);
	free(bytes);
}

static void check_names(struct fuzz *fuzz)
{
	char host[300], origin[300];

	fuzz_line(fuzz, host, sizeof(host));
	fuzz_line(fuzz, origin, sizeof(origin));
	if (origin_host(host, "192.168.1.5", "pi.example", "house, other"))
		TEST_ASSERT_TRUE(strpbrk(host, "/@?#% ,") == NULL);
	if (!origin_foreign(host, origin, NULL))
		TEST_ASSERT_EQUAL_size_t(strlen(host), strlen(strstr(origin, "://")) - 3);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	struct fuzz fuzz = {.at = bytes, .end = bytes + n};
	uint8_t what = fuzz_byte(&fuzz);

	if (what % 3 == 0)
		check_head((const char *)fuzz.at, fuzz_left(&fuzz));
	else if (what % 3 == 1)
		check_body((const char *)fuzz.at, fuzz_left(&fuzz));
	else
		check_names(&fuzz);
}
