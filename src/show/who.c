/* SPDX-License-Identifier: MIT */
/* Who did something: the program, its user, and the person for whom it did it. */
#include <pwd.h>
#include <stdio.h>

#include "src/show/who.h"

const char *who_program(const struct ows_by *who, char text[WHO_TEXT])
{
	if (!who->serial)
		snprintf(text, WHO_TEXT, "owsd");
	else if (who->pid)
		snprintf(text, WHO_TEXT, "%s[%d]", who->name, (int)who->pid);
	else
		snprintf(text, WHO_TEXT, "%s", *who->name ? who->name : "?");
	return text;
}

const char *who_user(const struct ows_by *who, char text[WHO_TEXT])
{
	const struct passwd *user = who->serial ? getpwuid(who->uid) : NULL;

	if (!who->serial)
		snprintf(text, WHO_TEXT, "-");
	else if (user)
		snprintf(text, WHO_TEXT, "%s", user->pw_name);
	else
		snprintf(text, WHO_TEXT, "%u", (unsigned)who->uid);
	return text;
}

const char *who_line(const struct ows_by *who, char text[WHO_LINE])
{
	char program[WHO_TEXT], user[WHO_TEXT];

	who_program(who, program);
	if (!who->serial)
		snprintf(text, WHO_LINE, "%s", program);
	else
		snprintf(text, WHO_LINE, "%s (user %s)%s%s", program, who_user(who, user),
		         *who->person ? " for " : "", who->person);
	return text;
}

void who_json(struct json *json, const struct ows_by *who)
{
	char user[WHO_TEXT];

	if (!who->serial) {
		json_null(json, "by");
		return;
	}
	json_object(json, "by");
	json_string(json, "program", who->name);
	json_int(json, "pid", who->pid);
	json_uint(json, "uid", who->uid);
	json_string(json, "user", who_user(who, user));
	json_string(json, "person", *who->person ? who->person : NULL);
	json_object_end(json);
}
