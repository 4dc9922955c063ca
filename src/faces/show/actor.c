/* SPDX-License-Identifier: MIT */
/* Who did something: the program, its user, and the person for whom it did it. */
#include <pwd.h>
#include <stdio.h>

#include "src/faces/show/actor.h"

const char *actor_program(const struct ows_by *who, char text[ACTOR_TEXT])
{
	if (!who->serial)
		snprintf(text, ACTOR_TEXT, "owsd");
	else if (who->pid)
		snprintf(text, ACTOR_TEXT, "%s[%d]", who->name, (int)who->pid);
	else
		snprintf(text, ACTOR_TEXT, "%s", *who->name ? who->name : "?");
	return text;
}

const char *actor_user(const struct ows_by *who, char text[ACTOR_TEXT])
{
	struct passwd user, *found = NULL;
	char room[4096];

	/* threads of owsd-web ask at the same time */
	if (who->serial && getpwuid_r(who->uid, &user, room, sizeof(room), &found))
		found = NULL;
	if (!who->serial)
		snprintf(text, ACTOR_TEXT, "-");
	else if (found)
		snprintf(text, ACTOR_TEXT, "%s", found->pw_name);
	else
		snprintf(text, ACTOR_TEXT, "%u", (unsigned)who->uid);
	return text;
}

const char *actor_line(const struct ows_by *who, char text[ACTOR_LINE])
{
	char program[ACTOR_TEXT], user[ACTOR_TEXT];

	actor_program(who, program);
	if (!who->serial)
		snprintf(text, ACTOR_LINE, "%s", program);
	else
		snprintf(text, ACTOR_LINE, "%s (user %s)%s%s", program, actor_user(who, user),
		         *who->person ? " for " : "", who->person);
	return text;
}

void actor_json(struct json *json, const struct ows_by *who)
{
	char user[ACTOR_TEXT];

	if (!who->serial) {
		json_null(json, "by");
		return;
	}
	json_object(json, "by");
	json_string(json, "program", who->name);
	json_int(json, "pid", who->pid);
	json_uint(json, "uid", who->uid);
	json_string(json, "user", actor_user(who, user));
	json_string(json, "person", *who->person ? who->person : NULL);
	json_object_end(json);
}
