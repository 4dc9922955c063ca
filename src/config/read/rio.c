/* SPDX-License-Identifier: MIT */
/*
 * The reader of .rio files: bytes become a document of nodes with their positions. After an error
 * the reader goes on where the next key may begin, and marks the block as broken: then a key that
 * seems to be missing is no second error.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/rio.h"

struct spot {
	const char *p;
	int line;
	/* the column of some earlier byte of the line, so that a long line is counted only once */
	const char *counted;
	int column;
};

struct parser {
	struct rio *rio;
	struct config_report *report;
	const char *file, *end;
	struct spot at;
	bool no_memory, stopped;
	size_t used; /* of value */
	char value[RIO_VALUE_MAX];
};

size_t rio_line_end_length(const char *p, const char *end)
{
	if (*p == '\r')
		return p + 1 < end && p[1] == '\n' ? 2 : 1;
	return *p == '\n';
}

static struct rio_position position_here(struct parser *p)
{
	for (; p->at.counted < p->at.p; p->at.counted++)
		p->at.column += ((unsigned char)*p->at.counted & 0xc0) != 0x80;
	return (struct rio_position){p->file, p->at.line, p->at.column};
}

static size_t offset_here(const struct parser *p)
{
	return (size_t)(p->at.p - p->rio->text);
}

static bool at_end(const struct parser *p)
{
	return p->at.p == p->end;
}

static char peek_byte(const struct parser *p)
{
	return at_end(p) ? '\0' : *p->at.p;
}

static bool at_line_end(const struct parser *p)
{
	return !at_end(p) && rio_line_end_length(p->at.p, p->end);
}

static void skip_line_end(struct parser *p)
{
	p->at.p += rio_line_end_length(p->at.p, p->end);
	p->at.line++;
	p->at.counted = p->at.p;
	p->at.column = 1;
}

static void skip_line(struct parser *p)
{
	while (!at_end(p) && !at_line_end(p))
		p->at.p++;
}

/* Skip blanks, line ends and comments. */
static void skip_blanks(struct parser *p)
{
	while (!at_end(p)) {
		if (at_line_end(p))
			skip_line_end(p);
		else if (*p->at.p == '#')
			skip_line(p);
		else if (*p->at.p == ' ' || *p->at.p == '\t')
			p->at.p++;
		else
			return;
	}
}

static bool is_letter(char c)
{
	return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
}

static bool is_key(char c)
{
	return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '-';
}

static bool ends_word(char c)
{
	return c == ' ' || c == '\t' || c == '\n' || c == '\r' || strchr("{}[]\"#", c);
}

static bool is_control(char c)
{
	return ((unsigned char)c < ' ' && c != '\t') || c == 0x7f;
}

static struct rio_node *node_make(struct parser *p, struct rio_node *parent)
{
	struct rio_node *node = arena_take(&p->rio->arena, sizeof(*node));

	if (!node) {
		p->no_memory = true;
		return NULL;
	}
	node->key = node->value = "";
	node->at = node->value_at = position_here(p);
	node->begin = offset_here(p);
	node->parent = parent;
	if (parent->last)
		parent->last->next = node;
	else
		parent->first = node;
	parent->last = node;
	return node;
}

static const char *keep(struct parser *p, const char *text, size_t len)
{
	const char *copy = arena_text(&p->rio->arena, text, len);

	if (!copy)
		p->no_memory = true;
	return copy ? copy : "";
}

static void add_to_value(struct parser *p, char c)
{
	if (p->used < sizeof(p->value))
		p->value[p->used] = c;
	p->used++;
}

/* Store in the node what add_to_value() collected; reports an error when it was too long. */
static void parse_value(struct parser *p, struct rio_node *node)
{
	if (p->used > sizeof(p->value)) {
		report_error(p->report, node->value_at, "the value of %s is longer than %d bytes",
		             node->key, RIO_VALUE_MAX);
		node->broken = true;
		p->used = 0;
	}
	node->value = keep(p, p->value, p->used);
}

static void refuse_control(struct parser *p, struct rio_node *node)
{
	struct rio_position here = position_here(p);

	if (!node->broken)
		report_error(p->report, here, "a control character (byte 0x%02X) is not allowed",
		             (unsigned char)*p->at.p);
	node->broken = true;
}

static void parse_piece(struct parser *p, struct rio_node *node)
{
	struct rio_position begin = position_here(p);

	for (p->at.p++; !at_end(p) && !at_line_end(p) && *p->at.p != '"'; p->at.p++) {
		char c = *p->at.p, next = p->at.p + 1 < p->end ? p->at.p[1] : '\0';

		if (c == '\\' && (next == '"' || next == '\\'))
			c = *++p->at.p;
		else if (is_control(c))
			refuse_control(p, node);
		add_to_value(p, c);
	}
	if (peek_byte(p) == '"') {
		p->at.p++;
		return;
	}
	report_error(p->report, begin,
	             "expected '\"' at the end of the string, found the end of the %s",
	             at_end(p) ? "file" : "line");
	node->broken = true;
}

static void parse_string(struct parser *p, struct rio_node *node)
{
	struct spot behind;

	node->kind = RIO_STRING;
	p->used = 0;
	do {
		parse_piece(p, node);
		behind = p->at;
		skip_blanks(p);
	} while (peek_byte(p) == '"' && !node->broken);
	p->at = behind;
	parse_value(p, node);
}

static void parse_word(struct parser *p, struct rio_node *node)
{
	node->kind = RIO_WORD;
	p->used = 0;
	for (; !at_end(p) && *p->at.p && !ends_word(*p->at.p); p->at.p++) {
		if (is_control(*p->at.p))
			refuse_control(p, node);
		add_to_value(p, *p->at.p);
	}
	parse_value(p, node);
}

static void parse_list(struct parser *p, struct rio_node *node)
{
	const char *begin = p->at.p;

	node->kind = RIO_LIST;
	for (p->at.p++; !at_end(p) && !strchr("]{}", *p->at.p);) {
		if (*p->at.p == '"')
			parse_piece(p, node);
		else if (at_line_end(p) || *p->at.p == '#')
			skip_blanks(p);
		else
			p->at.p++;
	}
	if (peek_byte(p) == ']') {
		p->at.p++;
	} else {
		report_error(p->report, node->value_at, "expected ']' at the end of the list");
		node->broken = true;
	}
	node->value = keep(p, begin, (size_t)(p->at.p - begin));
}

static void parse_entries(struct parser *p, struct rio_node *block, int depth);

static void parse_block(struct parser *p, struct rio_node *node, int depth)
{
	node->kind = RIO_BLOCK;
	p->at.p++;
	node->value_begin = offset_here(p);
	if (depth >= RIO_DEPTH_MAX) {
		report_error(p->report, node->value_at, "blocks are nested deeper than %d",
		             RIO_DEPTH_MAX);
		node->broken = p->stopped = true;
		p->at.p = p->end;
	} else {
		parse_entries(p, node, depth + 1);
	}
	node->value_end = offset_here(p);
	if (peek_byte(p) == '}') {
		p->at.p++;
	} else if (!p->stopped) {
		report_error(p->report, position_here(p), "expected '}' to end %s of line %d",
		             *node->key ? node->key : "the block", node->at.line);
		node->broken = true;
	}
}

static void parse_key(struct parser *p, struct rio_node *node)
{
	const char *begin = p->at.p;
	size_t len;

	while (!at_end(p) && is_key(*p->at.p))
		p->at.p++;
	len = (size_t)(p->at.p - begin);
	if (len > RIO_KEY_MAX) {
		report_error(p->report, node->at, "the key is longer than %d bytes", RIO_KEY_MAX);
		node->broken = true;
		len = RIO_KEY_MAX;
	}
	node->key = keep(p, begin, len);
}

/*
 * An entry: a key and its value, in one line, so that a key without value does not take the next
 * word.
 */
static void parse_entry(struct parser *p, struct rio_node *block, int depth)
{
	struct rio_node *node = node_make(p, block);
	struct spot behind;
	int line;

	if (!node)
		return;
	if (peek_byte(p) != '{')
		parse_key(p, node);
	behind = p->at;
	line = p->at.line;
	skip_blanks(p);
	node->value_at = position_here(p);
	node->value_begin = offset_here(p);
	if (peek_byte(p) == '{') {
		parse_block(p, node, depth);
	} else {
		if (peek_byte(p) == '"') {
			parse_string(p, node);
		} else if (peek_byte(p) == '[') {
			parse_list(p, node);
		} else if (p->at.line == line && peek_byte(p) && !ends_word(peek_byte(p))) {
			parse_word(p, node);
		} else {
			p->at = behind;
			node->value_begin = offset_here(p);
			report_error(p->report, position_here(p), "expected a value after %s",
			             node->key);
			node->broken = true;
		}
		node->value_end = offset_here(p);
	}
	node->end = offset_here(p);
	block->broken |= node->broken && node->kind != RIO_BLOCK;
}

static void refuse_here(struct parser *p, struct rio_node *block, int depth)
{
	const char *inside = depth ? " or '}'" : "";
	char c = *p->at.p;

	if (c == '{')
		report_error(p->report, position_here(p), "expected a key before '{'");
	else if (is_control(c))
		report_error(p->report, position_here(p), "expected a key%s, found the byte 0x%02X",
		             inside, (unsigned char)c);
	else if ((unsigned char)c >= 0x80)
		report_error(p->report, position_here(p), "expected a key%s", inside);
	else
		report_error(p->report, position_here(p), "expected a key%s, found '%c'%s", inside,
		             c, c == '/' || c == ';' ? "; comments begin with #" : "");
	block->broken = true;
}

static void parse_entries(struct parser *p, struct rio_node *block, int depth)
{
	for (skip_blanks(p); !at_end(p) && !p->no_memory; skip_blanks(p)) {
		if (is_letter(*p->at.p)) {
			parse_entry(p, block, depth);
		} else if (*p->at.p == '}' && depth) {
			return;
		} else {
			refuse_here(p, block, depth);
			/* read as a block without a key, so that the brackets still pair */
			if (*p->at.p == '{')
				parse_entry(p, block, depth);
			else if (*p->at.p == '}')
				p->at.p++;
			else
				skip_line(p);
		}
	}
}

static const char *find_line_end(const char *text, size_t len)
{
	const char *end = text + len;

	while (text < end && !rio_line_end_length(text, end))
		text++;
	if (text == end || *text == '\n')
		return "\n";
	return rio_line_end_length(text, end) == 2 ? "\r\n" : "\r";
}

int rio_parse(const char *file, const char *text, size_t len, struct config_report *report,
              struct rio **rio)
{
	struct rio *made;
	struct parser *p;
	int err = 0;

	*rio = NULL;
	if (len > RIO_FILE_MAX) {
		report_error(report, (struct rio_position){file, 0, 0}, "longer than %u bytes",
		             RIO_FILE_MAX);
		return -EFBIG;
	}
	made = calloc(1, sizeof(*made));
	p = calloc(1, sizeof(*p));
	if (made)
		made->text = arena_text(&made->arena, text, len);
	if (!made || !p || !made->text) {
		err = -ENOMEM;
		goto out;
	}
	made->len = len;
	made->line_end = find_line_end(text, len);
	made->root = (struct rio_node){.kind = RIO_BLOCK,
	                               .key = "",
	                               .value = "",
	                               .end = len,
	                               .value_end = len,
	                               .at = {file, 1, 1}};
	*p = (struct parser){.rio = made,
	                     .report = report,
	                     .file = file,
	                     .end = made->text + len,
	                     .at = {.p = made->text, .line = 1, .column = 1}};
	if (len >= 3 && !memcmp(text, "\xef\xbb\xbf", 3))
		p->at.p += 3;
	made->root.value_begin = offset_here(p);
	p->at.counted = p->at.p;
	parse_entries(p, &made->root, 0);
	err = p->no_memory ? -ENOMEM : 0;
out:
	free(p);
	if (err)
		rio_free(made);
	else
		*rio = made;
	return err;
}

void rio_free(struct rio *rio)
{
	if (!rio)
		return;
	arena_free(&rio->arena);
	free(rio);
}

static struct rio_node *find_from(struct rio_node *node, const char *key)
{
	while (node && strcmp(node->key, key))
		node = node->next;
	return node;
}

struct rio_node *rio_child(const struct rio_node *block, const char *key)
{
	return find_from(block->first, key);
}

struct rio_node *rio_next(const struct rio_node *node)
{
	return find_from(node->next, node->key);
}
