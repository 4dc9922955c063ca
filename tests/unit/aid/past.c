/* SPDX-License-Identifier: MIT */
/* A history in a folder, in virtual time. */
#include "tests/unit/aid/past.h"

#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "tests/unit/aid/folder.h"

const struct history_signal past_signals[PAST_COUNT] = {
	{"room", "°C", OWS_DOUBLE, 0, 2},
	{"lamp", "", OWS_BOOL, 1, -1},
	{"title", "", OWS_STRING, 0, -1},
};

static void hear(void *ctx, const char *text)
{
	struct past *past = ctx;

	snprintf(past->said, sizeof(past->said), "%s", text);
}

void past_make(struct past *past)
{
	static int folders;

	*past = (struct past){.options = {.boot = 1, .flush_ns = 10 * PAST_S, .say = hear}};
	past->options.ctx = past;
	past->options.directory = past->directory;
	snprintf(past->directory, sizeof(past->directory), "%s/past%d", folder_dir()->path,
	         folders++);
}

void past_begin(struct past *past, int64_t now_ns, int64_t offset_ns, bool trusted)
{
	TEST_ASSERT_EQUAL_INT(
		0, history_writer_open(&past->options, now_ns, offset_ns, trusted, &past->writer));
	TEST_ASSERT_EQUAL_INT(
		0, history_writer_signals(past->writer, past_signals, PAST_COUNT, now_ns));
	history_writer_begin(past->writer, now_ns);
}

void past_room(struct past *past, int64_t time_ns, double value)
{
	history_writer_value(past->writer, PAST_ROOM, time_ns, OWS_Q_GOOD, value_of_double(value),
	                     NULL, 0);
}

void past_lamp(struct past *past, int64_t time_ns, int64_t value)
{
	history_writer_value(past->writer, PAST_LAMP, time_ns, OWS_Q_GOOD, value, NULL, 0);
}

void past_title(struct past *past, int64_t time_ns, const char *text)
{
	history_writer_value(past->writer, PAST_TITLE, time_ns, OWS_Q_GOOD, 0, text, strlen(text));
}

void past_end(struct past *past, int64_t now_ns)
{
	struct history_writer *writer = past->writer;

	past->writer = NULL;
	TEST_ASSERT_EQUAL_INT(0, history_writer_close(writer, now_ns));
}

int past_items(struct past *past, int signal, struct ows_history_item **items)
{
	static struct ows_history_item found[PAST_MOST];
	struct ows_history *h;
	int count = 0, got, index;

	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, past->directory, &h));
	index = ows_history_find(h, past_signals[signal].name);
	TEST_ASSERT_TRUE(index >= 0);
	TEST_ASSERT_EQUAL_INT(0, ows_history_read(h, index, 0, INT64_MAX));
	while ((got = ows_history_next(h, &found[count], PAST_MOST - count)) > 0)
		count += got;
	TEST_ASSERT_EQUAL_INT(0, got);
	ows_history_close(h);
	*items = found;
	return count;
}

int64_t past_ask(struct past *past, const char *text)
{
	char path[400];
	sqlite3 *db;
	sqlite3_stmt *statement;
	int64_t value;

	snprintf(path, sizeof(path), "%s/history.sqlite", past->directory);
	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_open_v2(path, &db, SQLITE_OPEN_READONLY, NULL));
	TEST_ASSERT_EQUAL_INT_MESSAGE(SQLITE_OK, sqlite3_prepare_v2(db, text, -1, &statement, NULL),
	                              sqlite3_errmsg(db));
	TEST_ASSERT_EQUAL_INT(SQLITE_ROW, sqlite3_step(statement));
	value = sqlite3_column_int64(statement, 0);
	sqlite3_finalize(statement);
	sqlite3_close(db);
	return value;
}

unsigned past_random(unsigned below)
{
	static uint64_t state = 1;

	state = state * 6364136223846793005u + 1442695040888963407u;
	return (unsigned)(state >> 33) % below;
}
