/* SPDX-License-Identifier: MIT */
/* Changes of a document in its text: what is not changed keeps every byte. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/rio_write.h"

/* A text that grows; text NULL: no memory. */
struct grow {
	char *text;
	size_t len, room;
};

static void grow_add(struct grow *grow, const char *text, size_t len)
{
	char *more;

	if (!grow->text)
		return;
	if (grow->room - grow->len <= len) {
		grow->room = (grow->len + len + 1) * 2;
		more = realloc(grow->text, grow->room);
		if (!more)
			free(grow->text);
		grow->text = more;
		if (!more)
			return;
	}
	memcpy(grow->text + grow->len, text, len);
	grow->len += len;
	grow->text[grow->len] = '\0';
}

static struct grow grow_make(void)
{
	return (struct grow){.text = calloc(1, 64), .room = 64};
}

char *rio_quote(const char *text)
{
	struct grow out = grow_make();
	size_t in_line = 0;

	grow_add(&out, "\"", 1);
	for (const char *p = text; *p; p++) {
		bool begins_character = ((unsigned char)*p & 0xc0) != 0x80;

		if (in_line >= RIO_WRAP && begins_character) {
			grow_add(&out, "\"\n\"", 3);
			in_line = 0;
		}
		if (*p == '"' || *p == '\\')
			grow_add(&out, "\\", 1);
		grow_add(&out, p, 1);
		in_line++;
	}
	grow_add(&out, "\"", 1);
	return out.text;
}

void rio_quote_free(char *quoted)
{
	free(quoted);
}

static void grow_add_lines(struct grow *grow, const char *lines, const char *line_end)
{
	for (;;) {
		size_t len = strcspn(lines, "\n");

		grow_add(grow, lines, len);
		if (!lines[len])
			return;
		grow_add(grow, line_end, strlen(line_end));
		lines += len + 1;
	}
}

/* Replace the bytes begin to end by what was grown, which is freed. */
static int splice_bytes(struct rio **rio, size_t begin, size_t end, struct grow *put)
{
	struct config_report silent = {0};
	struct grow out = grow_make();
	struct rio *made;
	int err;

	grow_add(&out, (*rio)->text, begin);
	if (!put->text) {
		free(out.text);
		return -ENOMEM;
	}
	grow_add(&out, put->text, put->len);
	free(put->text);
	grow_add(&out, (*rio)->text + end, (*rio)->len - end);
	if (!out.text)
		return -ENOMEM;
	err = rio_parse((*rio)->root.at.file, out.text, out.len, &silent, &made);
	free(out.text);
	if (err)
		return err;
	rio_free(*rio);
	*rio = made;
	return 0;
}

/* Replace the bytes begin to end by text, with the document's line ends. */
static int rio_splice(struct rio **rio, size_t begin, size_t end, const char *text)
{
	struct grow put = grow_make();

	grow_add_lines(&put, text, (*rio)->line_end);
	return splice_bytes(rio, begin, end, &put);
}

static bool is_blank(char c)
{
	return c == ' ' || c == '\t';
}

/* Does what begins there end a word that comes to stand before it? */
static bool ends_word_at(const struct rio *rio, size_t offset)
{
	return offset == rio->len || strchr(" \t\r\n}#", rio->text[offset]) != NULL;
}

/* First byte of the line of offset. */
static size_t line_begin(const struct rio *rio, size_t offset)
{
	while (offset && rio->text[offset - 1] != '\n' && rio->text[offset - 1] != '\r')
		offset--;
	return offset;
}

static size_t line_end_length(const struct rio *rio, size_t offset)
{
	return offset < rio->len ? rio_line_end_length(rio->text + offset, rio->text + rio->len)
	                         : 0;
}

/* The line's end, or that of the text. */
static size_t line_end_at(const struct rio *rio, size_t offset)
{
	while (offset < rio->len && !line_end_length(rio, offset))
		offset++;
	return offset;
}

static bool blank_between(const struct rio *rio, size_t begin, size_t end)
{
	while (begin < end && is_blank(rio->text[begin]))
		begin++;
	return begin == end;
}

/* Does the node begin its line? Then new ones get lines of their own. */
static bool begins_line(const struct rio *rio, const struct rio_node *node)
{
	return blank_between(rio, line_begin(rio, node->begin), node->begin);
}

/*
 * The end of the line if only blanks or a comment follow the node there; else the end of the node.
 */
static size_t behind_line(const struct rio *rio, const struct rio_node *node)
{
	size_t end = line_end_at(rio, node->end), p = node->end;

	while (p < end && is_blank(rio->text[p]))
		p++;
	return p == end || rio->text[p] == '#' ? end : node->end;
}

static void add_indented(struct grow *out, const char *indent, size_t indent_len, const char *lines)
{
	while (*lines) {
		size_t len = strcspn(lines, "\n");

		grow_add(out, "\n", 1);
		/* the rest of a wrapped string has no indentation */
		if (*lines != '"')
			grow_add(out, indent, indent_len);
		grow_add(out, lines, len);
		lines += len + (lines[len] == '\n');
	}
}

/*
 * The lines to put after the node `after`, with its indentation; without `after` they come first in
 * the block, indented deeper than the block. They replace the text from *at to *end.
 */
static char *lines_behind(const struct rio *rio, const struct rio_node *block,
                          const struct rio_node *after, const char *lines, size_t *at, size_t *end)
{
	const struct rio_node *like = after ? after : block;
	size_t begin = line_begin(rio, like->begin);
	struct grow indent = grow_make(), out = grow_make();

	*at = *end = after ? behind_line(rio, after) : block->value_begin;
	if (blank_between(rio, begin, like->begin))
		grow_add(&indent, rio->text + begin, like->begin - begin);
	if (!after)
		grow_add(&indent, "  ", 2);
	if (indent.text)
		add_indented(&out, indent.text, indent.len, lines);
	/* the rest of that line goes to a line of its own */
	if (indent.text && !blank_between(rio, *at, line_end_at(rio, *at))) {
		grow_add(&out, "\n", 1);
		grow_add(&out, indent.text, indent.len >= 2 ? indent.len - 2 : 0);
		while (is_blank(rio->text[*end]))
			++*end;
	}
	if (!indent.text) {
		free(out.text);
		out.text = NULL;
	}
	free(indent.text);
	return out.text;
}

static int add_behind(struct rio **rio, const struct rio_node *block, const struct rio_node *after,
                      const char *lines)
{
	struct grow out;
	size_t at, end;
	int err;

	if (!after || begins_line(*rio, after)) {
		out.text = lines_behind(*rio, block, after, lines, &at, &end);
	} else {
		at = end = after->end;
		out = grow_make();
		grow_add(&out, " ", 1);
		grow_add(&out, lines, strlen(lines));
		if (!ends_word_at(*rio, at))
			grow_add(&out, " ", 1);
	}
	err = out.text ? rio_splice(rio, at, end, out.text) : -ENOMEM;
	free(out.text);
	return err;
}

int rio_add(struct rio **rio, struct rio_node *block, const char *lines)
{
	return add_behind(rio, block, block->last, lines);
}

/* A value that stands at its key without a blank, as =5 may, gets one. */
int rio_replace(struct rio **rio, const struct rio_node *node, const char *value)
{
	struct grow out = grow_make();
	int err;

	if (node->value_begin == node->begin + strlen(node->key))
		grow_add(&out, " ", 1);
	grow_add(&out, value, strlen(value));
	err = out.text ? rio_splice(rio, node->value_begin, node->end, out.text) : -ENOMEM;
	free(out.text);
	return err;
}

int rio_set(struct rio **rio, struct rio_node *block, const char *key, const char *value)
{
	const struct rio_node *node = rio_child(block, key), *after = NULL;
	struct grow line;
	char padded[RIO_KEY_MAX + 2];
	int err;

	if (node)
		return rio_replace(rio, node, value);
	for (node = block->first; node; node = node->next)
		if (node->kind != RIO_BLOCK)
			after = node;
	line = grow_make();
	snprintf(padded, sizeof(padded), "%-*s ", RIO_KEY_WIDTH - 1, key);
	grow_add(&line, padded, strlen(padded));
	grow_add(&line, value, strlen(value));
	err = line.text ? add_behind(rio, block, after, line.text) : -ENOMEM;
	free(line.text);
	return err;
}

int rio_remove(struct rio **rio, struct rio_node *node)
{
	size_t begin = node->begin, end = node->end, line = line_begin(*rio, begin),
	       rest = line_end_at(*rio, end);

	if (blank_between(*rio, line, begin) && blank_between(*rio, end, rest)) {
		begin = line;
		end = rest + line_end_length(*rio, rest);
	} else if (ends_word_at(*rio, end)) {
		while (begin > line && is_blank((*rio)->text[begin - 1]) && begin - 1 > line)
			begin--;
	}
	return rio_splice(rio, begin, end, "");
}

/* Does a line hold a comment and nothing else? */
static bool is_comment(const struct rio *rio, size_t line)
{
	while (line < rio->len && is_blank(rio->text[line]))
		line++;
	return line < rio->len && rio->text[line] == '#';
}

/* First byte of the line before that of offset; offset where there is none. */
static size_t line_before(const struct rio *rio, size_t offset)
{
	size_t line = line_begin(rio, offset);

	if (!line)
		return offset;
	line--;
	if (line && rio->text[line] == '\n' && rio->text[line - 1] == '\r')
		line--;
	return line_begin(rio, line);
}

/*
 * The lines of a node and of the comments directly above it; false: other text is on these lines.
 */
static bool own_lines(const struct rio *rio, const struct rio_node *node, size_t *begin,
                      size_t *end)
{
	size_t line = line_begin(rio, node->begin), above;

	*end = line_end_at(rio, node->end);
	if (!begins_line(rio, node) || behind_line(rio, node) != *end ||
	    !line_end_length(rio, *end))
		return false;
	*end += line_end_length(rio, *end);
	while ((above = line_before(rio, line)) < line && is_comment(rio, above) &&
	       above >= node->parent->value_begin)
		line = above;
	*begin = line;
	return true;
}

int rio_move(struct rio **rio, struct rio_node *node, const struct rio_node *other, bool behind)
{
	size_t begin, end, at, other_begin, other_end, from, to;
	struct grow out;

	if (!own_lines(*rio, node, &begin, &end) ||
	    !own_lines(*rio, other, &other_begin, &other_end))
		return -EINVAL;
	at = behind ? other_end : other_begin;
	if (at >= begin && at <= end)
		return 0;
	/* what stands between the two places changes sides with the node */
	from = at < begin ? at : begin;
	to = at < begin ? end : at;
	out = grow_make();
	if (at < begin)
		grow_add(&out, (*rio)->text + begin, end - begin);
	grow_add(&out, (*rio)->text + (at < begin ? at : end), at < begin ? begin - at : at - end);
	if (at > end)
		grow_add(&out, (*rio)->text + begin, end - begin);
	return splice_bytes(rio, from, to, &out);
}
