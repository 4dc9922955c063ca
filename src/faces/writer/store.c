/* SPDX-License-Identifier: MIT */
/* Compares, checks and replaces the file of the configuration, and keeps the file of before. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/config/check/check.h"
#include "src/config/edit/edit.h"
#include "src/config/edit/replace.h"
#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/config/read/rio_file.h"
#include "src/daemon/host/target.h"
#include "src/faces/writer/store.h"

static void take_problem(void *ctx, bool is_error, int line, int column, const char *text)
{
	answer_problem(ctx, is_error, line, column, text);
}

/*
 * Check a text as owsd --check does, as if it stood in file: tables and simulations that it names
 * are read. Problems go to the answer. 0 or a negative errno. Blocking.
 */
static int check_text(const char *file, const char *text, size_t len, struct answer *answer)
{
	struct config_report report = {.problem = take_problem, .ctx = answer, .keeps_wrong = true};
	struct config *config;
	int err = config_parse(file, text, len, &report, &config);

	if (config)
		err = target_check_config(config, &report);
	config_free(config);
	return err;
}

void store_check_items(const char *text, size_t len, struct answer *answer)
{
	struct config_report report = {.problem = take_problem, .ctx = answer},
			     silent = {.keeps_wrong = true};
	struct config *config;

	(void)config_parse("draft", text, len, &silent, &config);
	if (config)
		config_check_items(config, NULL, &report);
	config_free(config);
}

/* A file as it is on disk. */
struct stored {
	char *text; /* NULL: there is none */
	size_t len;
	struct stat st;
	char tag[TAG_TEXT]; /* "": there is none */
};

static void say_unreadable(void *ctx, bool is_error, int line, int column, const char *text)
{
	struct answer *answer = ctx;

	(void)is_error, (void)line, (void)column;
	answer_say(answer, ANSWER_ERROR, "%s", text);
}

/* One that is not there has no text. Otherwise a negative errno is in the answer. */
static int store_load(const char *file, struct stored *stored, struct answer *answer)
{
	struct config_report report = {.problem = say_unreadable, .ctx = answer};
	char words[ANSWER_WHY];
	int err;

	*stored = (struct stored){0};
	if (lstat(file, &stored->st) && errno == ENOENT)
		return 0;
	err = rio_read(file, &report, &stored->text, &stored->len);
	if (!err && stat(file, &stored->st))
		err = -errno;
	if (err) {
		memcpy(words, answer->why, sizeof(words));
		answer_say(answer, ANSWER_ERROR, "%s: %s", file, *words ? words : strerror(-err));
		return err;
	}
	tag_print(stored->text, stored->len, stored->tag);
	return 0;
}

static void store_forget(struct stored *stored)
{
	free(stored->text);
	stored->text = NULL;
}

static void show_tag(struct answer *answer, const char *tag)
{
	answer->has_tag = true;
	memcpy(answer->tag, tag, TAG_TEXT);
}

static void show_backup(const char *backup, const char *tag, struct answer *answer)
{
	struct stat st;

	if (stat(backup, &st))
		return;
	memcpy(answer->backup, tag, TAG_TEXT);
	answer->backup_ms = (int64_t)st.st_mtim.tv_sec * 1000 + st.st_mtim.tv_nsec / 1000000;
}

/* The file while it is locked. */
struct change {
	const char *file;
	char backup[PATH_MAX];
	struct stored present;
	struct answer *answer;
};

static bool is_base(const struct change *c, const struct order *order)
{
	show_tag(c->answer, c->present.tag);
	/* who renames names what is there now */
	if (order->kind == ORDER_RENAME || strcmp(c->present.tag, order->base) == 0)
		return true;
	answer_say(c->answer, ANSWER_CONFLICT,
	           *c->present.tag ? "the file was changed meanwhile: look at it again"
	                           : "the file is not there any more");
	return false;
}

static void say_failed(const char *file, int err, struct answer *answer)
{
	if (err == -EPERM)
		answer_say(answer, ANSWER_ERROR,
		           "%s: its owner or group cannot be kept, and without it a user could no "
		           "longer read the file: chgrp owsd and chmod 640, or chmod 644",
		           file);
	else
		answer_say(answer, ANSWER_ERROR, "%s cannot be written: %s", file, strerror(-err));
}

/* A link in the place of the file of before is replaced itself. */
static int remove_link(const char *path)
{
	struct stat st;

	if (lstat(path, &st))
		return errno == ENOENT ? 0 : -errno;
	return S_ISLNK(st.st_mode) && unlink(path) ? -errno : 0;
}

/*
 * Both are on the disk before one of them is in place. What is in place first is what a writer that
 * is killed then leaves: backup first keeps two copies of the present text, file first two of the
 * text of before.
 */
static int write_both(const struct change *c, bool backup_first, const char *text, size_t len)
{
	const struct stored *present = &c->present;
	struct replacement new, old;
	int err = replace_prepare(&new, c->file, present->text ? &present->st : NULL, text, len);

	if (err) {
		say_failed(c->file, err, c->answer);
		return err;
	}
	err = present->text ? remove_link(c->backup) : 0;
	if (!err && present->text)
		err = replace_prepare(&old, c->backup, &present->st, present->text, present->len);
	if (!err && present->text && backup_first) {
		err = replace_commit(&old);
		if (!err)
			show_backup(c->backup, present->tag, c->answer);
	}
	if (err) {
		replace_abandon(&new);
		say_failed(c->backup, err, c->answer);
		return err;
	}
	err = replace_commit(&new);
	if (err)
		say_failed(c->file, err, c->answer);
	if (present->text && !backup_first && err)
		replace_abandon(&old);
	else if (present->text && !backup_first && replace_commit(&old) == 0)
		show_backup(c->backup, present->tag, c->answer);
	return err;
}

/* Nothing is to be written: the file of before stays what it is. */
static void leave_in_place(const struct change *c)
{
	struct stored before;

	if (store_load(c->backup, &before, c->answer) == 0 && before.text)
		show_backup(c->backup, before.tag, c->answer);
	store_forget(&before);
	show_tag(c->answer, c->present.tag);
}

static void exchange_texts(const struct change *c, bool backup_first, const char *text, size_t len)
{
	char tag[TAG_TEXT];

	if (check_text(c->file, text, len, c->answer)) {
		answer_say(c->answer, ANSWER_INVALID, "the text has errors");
		return;
	}
	if (c->present.text && c->present.len == len && memcmp(c->present.text, text, len) == 0) {
		leave_in_place(c);
	} else {
		if (write_both(c, backup_first, text, len))
			return;
		tag_print(text, len, tag);
		show_tag(c->answer, tag);
	}
	c->answer->status = ANSWER_DONE;
	*c->answer->why = '\0';
}

static void put_back(const struct change *c)
{
	struct stored before;
	int err = store_load(c->backup, &before, c->answer);

	if (!err && before.text)
		exchange_texts(c, false, before.text, before.len);
	else if (!err)
		answer_say(c->answer, ANSWER_REFUSED, "there is no %s: nothing was saved before",
		           c->backup);
	store_forget(&before);
}

/* What is wrong with a name is the reason; a warning is one of the text that follows. */
static void take_fault(void *ctx, bool is_error, int line, int column, const char *text)
{
	if (is_error)
		answer_say(ctx, ANSWER_REFUSED, "%s", text);
	else
		answer_problem(ctx, is_error, line, column, text);
}

static void rename_in(const struct change *c, const char *names)
{
	struct config_report silent = {0}, report = {.problem = take_fault, .ctx = c->answer};
	const char *to = strchr(names, '\n');
	char *name = to ? strndup(names, (size_t)(to - names)) : NULL;
	struct rio *rio = NULL;
	int err;

	if (!c->present.text || !name) {
		answer_say(c->answer, ANSWER_REFUSED,
		           "expected the name of an item, a line end and another name");
		free(name);
		return;
	}
	err = rio_parse(c->file, c->present.text, c->present.len, &silent, &rio);
	/* a text with errors is refused with all of them below */
	if (!err && !silent.errors)
		err = edit_rename(&rio, name, to + 1, &report);
	if (!err)
		exchange_texts(c, true, rio->text, rio->len);
	else if (!report.errors)
		answer_say(c->answer, ANSWER_ERROR, "%s", strerror(-err));
	rio_free(rio);
	free(name);
}

static int lock_config(const char *file, struct answer *answer)
{
	int fd = replace_lock(file);

	if (fd == -EBUSY)
		answer_say(answer, ANSWER_ERROR,
		           "another program keeps %s locked: try again in a moment", file);
	else if (fd < 0)
		say_failed(file, fd, answer);
	return fd;
}

void store_change(const char *file, const struct order *order, const char *body,
                  struct answer *answer)
{
	struct change c = {.file = file, .answer = answer};
	int fd = -1;

	if (snprintf(c.backup, sizeof(c.backup), "%s.before", file) >= (int)sizeof(c.backup))
		answer_say(answer, ANSWER_ERROR, "the name of the configuration is too long");
	else
		fd = lock_config(file, answer);
	if (fd < 0)
		return;
	if (store_load(file, &c.present, answer) == 0 && is_base(&c, order))
		switch (order->kind) {
		case ORDER_REPLACE:
			exchange_texts(&c, true, body, order->length);
			break;
		case ORDER_RESTORE:
			put_back(&c);
			break;
		case ORDER_RENAME:
			rename_in(&c, body);
			break;
		}
	store_forget(&c.present);
	replace_unlock(file, fd);
}
