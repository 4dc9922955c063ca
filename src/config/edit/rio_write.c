/* SPDX-License-Identifier: MIT */
/* Changes of a document in its text: what is not changed keeps every byte. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/edit/rio_write.h"

char *rio_quote(const char *text)
{
	static const char wrap[] = "\"\n\"";
	size_t len = strlen(text), in_line = 0;
	/* a backslash before each byte at most, two quotes and the end */
	char *quoted = malloc(2 * len + len / RIO_WRAP * strlen(wrap) + 3), *end = quoted;

	if (!quoted)
		return NULL;
	*end++ = '"';
	for (const char *p = text; *p; p++) {
		bool begins_character = ((unsigned char)*p & 0xc0) != 0x80;

		if (in_line >= RIO_WRAP && begins_character) {
			end = stpcpy(end, wrap);
			in_line = 0;
		}
		if (*p == '"' || *p == '\\')
			*end++ = '\\';
		*end++ = *p;
		in_line++;
	}
	memcpy(end, "\"", 2);
	return quoted;
}

/* Replace the bytes begin to end by those of put. */
static int splice_bytes(struct rio **rio, size_t begin, size_t end, const char *put, size_t put_len)
{
	struct config_report silent = {0};
	size_t behind = (*rio)->len - end, len = begin + put_len + behind;
	char *text = malloc(len + 1), *p = text;
	struct rio *made;
	int err;

	if (!text)
		return -ENOMEM;
	p = mempcpy(p, (*rio)->text, begin);
	p = mempcpy(p, put, put_len);
	memcpy(p, (*rio)->text + end, behind);
	err = rio_parse((*rio)->root.at.file, text, len, &silent, &made);
	free(text);
	if (err)
		return err;
	rio_free(*rio);
	*rio = made;
	return 0;
}

/* Replace the bytes begin to end by text, with the document's line ends. */
static int rio_splice(struct rio **rio, size_t begin, size_t end, const char *text)
{
	char *put = malloc(2 * strlen(text) + 1), *p = put;
	int err;

	if (!put)
		return -ENOMEM;
	for (; *text; text++)
		if (*text == '\n')
			p = stpcpy(p, (*rio)->line_end);
		else
			*p++ = *text;
	err = splice_bytes(rio, begin, end, put, (size_t)(p - put));
	free(put);
	return err;
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

/*
 * The lines to put after the node `after`, with its indentation; without `after` they come first in
 * the block, indented deeper than the block. They replace the text from *at to *end. NULL: no
 * memory.
 */
static char *lines_behind(const struct rio *rio, const struct rio_node *block,
                          const struct rio_node *after, const char *lines, size_t *at, size_t *end)
{
	const struct rio_node *like = after ? after : block;
	size_t begin = line_begin(rio, like->begin), size, len;
	const char *indent = rio->text + begin, *deeper = after ? "" : "  ";
	int blanks = blank_between(rio, begin, like->begin) ? (int)(like->begin - begin) : 0;
	char *text = NULL;
	FILE *out = open_memstream(&text, &size);

	if (!out)
		return NULL;
	*at = *end = after ? behind_line(rio, after) : block->value_begin;
	for (; *lines; lines += len + (lines[len] == '\n')) {
		len = strcspn(lines, "\n");
		/* the rest of a wrapped string has no indentation */
		if (*lines == '"')
			fprintf(out, "\n%.*s", (int)len, lines);
		else
			fprintf(out, "\n%.*s%s%.*s", blanks, indent, deeper, (int)len, lines);
	}
	/* the rest of that line goes to a line of its own, indented as the block */
	if (!blank_between(rio, *at, line_end_at(rio, *at))) {
		if (after)
			blanks = blanks > 2 ? blanks - 2 : 0;
		fprintf(out, "\n%.*s", blanks, indent);
		while (is_blank(rio->text[*end]))
			++*end;
	}
	if (!fclose(out))
		return text;
	free(text);
	return NULL;
}

static int add_behind(struct rio **rio, const struct rio_node *block, const struct rio_node *after,
                      const char *lines)
{
	char *text = NULL;
	size_t at = 0, end = 0;
	int err;

	if (!after || begins_line(*rio, after)) {
		text = lines_behind(*rio, block, after, lines, &at, &end);
	} else {
		at = end = after->end;
		if (asprintf(&text, " %s%s", lines, ends_word_at(*rio, at) ? "" : " ") < 0)
			return -ENOMEM;
	}
	err = text ? rio_splice(rio, at, end, text) : -ENOMEM;
	free(text);
	return err;
}

int rio_add(struct rio **rio, struct rio_node *block, const char *lines)
{
	return add_behind(rio, block, block->last, lines);
}

int rio_replace(struct rio **rio, const struct rio_node *node, const char *value)
{
	/* a value that stands at its key without a blank, as =5 may, gets one */
	bool touches = node->value_begin == node->begin + strlen(node->key);
	char *text;
	int err;

	if (asprintf(&text, "%s%s", touches ? " " : "", value) < 0)
		return -ENOMEM;
	err = rio_splice(rio, node->value_begin, node->end, text);
	free(text);
	return err;
}

int rio_set(struct rio **rio, struct rio_node *block, const char *key, const char *value)
{
	const struct rio_node *node = rio_child(block, key), *after = NULL;
	char *line;
	int err;

	if (node)
		return rio_replace(rio, node, value);
	for (node = block->first; node; node = node->next)
		if (node->kind != RIO_BLOCK)
			after = node;
	if (asprintf(&line, "%-*s %s", RIO_KEY_WIDTH - 1, key, value) < 0)
		return -ENOMEM;
	err = add_behind(rio, block, after, line);
	free(line);
	return err;
}

int rio_set_text(struct rio **rio, struct rio_node *block, const char *key, const char *text)
{
	char *quoted = rio_quote(text);
	int err = quoted ? rio_set(rio, block, key, quoted) : -ENOMEM;

	free(quoted);
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
	size_t begin, end, at, other_begin, other_end, from, middle, to;
	char *put;
	int err;

	if (!own_lines(*rio, node, &begin, &end) ||
	    !own_lines(*rio, other, &other_begin, &other_end))
		return -EINVAL;
	at = behind ? other_end : other_begin;
	if (at >= begin && at <= end)
		return 0;
	/* what stands between the two places changes sides with the node */
	from = at < begin ? at : begin;
	middle = at < begin ? begin : end;
	to = at < begin ? end : at;
	put = malloc(to - from);
	if (!put)
		return -ENOMEM;
	memcpy(put, (*rio)->text + middle, to - middle);
	memcpy(put + (to - middle), (*rio)->text + from, middle - from);
	err = splice_bytes(rio, from, to, put, to - from);
	free(put);
	return err;
}
