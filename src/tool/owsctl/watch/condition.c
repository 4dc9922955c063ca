/* SPDX-License-Identifier: MIT */
/* Conditions of `owsctl wait`: a comparison of a signal with a value. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/ground/signal/value.h"
#include "src/tool/owsctl/watch/condition.h"

/* Of each operator: does it hold for a value that is less, equal, greater? */
static const struct {
	const char *text;
	bool less, equal, greater, of_strings;
} ops[] = {
	{"=", .equal = true, .of_strings = true},
	{"==", .equal = true, .of_strings = true},
	{"!=", .less = true, .greater = true, .of_strings = true},
	{"<", .less = true},
	{"<=", .less = true, .equal = true},
	{">", .greater = true},
	{">=", .greater = true, .equal = true},
};

int condition_op(const char *text)
{
	for (int i = 0; i < (int)(sizeof(ops) / sizeof(ops[0])); i++)
		if (strcmp(text, ops[i].text) == 0)
			return i;
	return -1;
}

static int make_number(const char *text, struct condition *condition)
{
	char *end;

	errno = 0;
	condition->integer = strtoll(text, &end, 10);
	condition->has_integer = errno == 0 && end != text && *end == '\0';
	condition->number = strtod(text, &end);
	return end == text || *end || !isfinite(condition->number) ? -EINVAL : 0;
}

int condition_make(enum ows_type type, const char *op, const char *text,
                   struct condition *condition)
{
	int found = condition_op(op);

	if (found < 0)
		return -EINVAL;
	memset(condition, 0, sizeof(*condition));
	condition->op = found;
	condition->text = text;
	if (type == OWS_STRING)
		return ops[found].of_strings ? 0 : -EOPNOTSUPP;
	if (type == OWS_BOOL && value_parse(OWS_BOOL, text, &condition->integer) == 0) {
		condition->has_integer = true;
		condition->number = (double)condition->integer;
		return 0;
	}
	return make_number(text, condition);
}

bool condition_holds(const struct condition *condition, const struct reading *reading)
{
	enum ows_type type = (enum ows_type)reading->value.type;
	int order;

	if (type == OWS_STRING)
		order = reading->len != strlen(condition->text) ||
		        memcmp(reading->text, condition->text, reading->len) != 0;
	else if (condition->has_integer && !value_is_float(type))
		order = (reading->value.integer > condition->integer) -
		        (reading->value.integer < condition->integer);
	else
		order = (reading->value.number > condition->number) -
		        (reading->value.number < condition->number);
	return order < 0   ? ops[condition->op].less
	       : order > 0 ? ops[condition->op].greater
	                   : ops[condition->op].equal;
}
