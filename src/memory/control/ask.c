/* SPDX-License-Identifier: MIT */
/* Programs that ask for a reload: how they wait, and the answer. */
#include <errno.h>
#include <string.h>

#include "hal/base/bell.h"
#include "hal/base/time.h"
#include "src/ground/text/printable.h"
#include "src/memory/control/ask.h"

bool ask_waits(const struct control_seat *p)
{
	enum control_state state = control_state_of(p);

	return state == CONTROL_ASKING || state == CONTROL_ASKED;
}

int ask_begin(struct control *c, struct control_seat *p, const struct ows_hello *hello)
{
	unsigned waiting = 0;

	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		waiting += ask_waits(&c->seats[i]);
	if (waiting >= CONTROL_ASKERS)
		return -ENOSPC;
	p->who = (struct ows_who){.uid = p->peer.uid, .pid = p->peer.pid};
	controller_clean_name(p->who.name, hello->name);
	p->until_ns = c->now_ns + CONTROL_ASK_NS;
	__atomic_store_n(&p->state, CONTROL_ASKING, __ATOMIC_RELEASE);
	bell_ring(c->asked);
	return 0;
}

void ask_answer(const struct control *c, const struct control_seat *p, int err, const char *why)
{
	struct ows_welcome answer = {
		.magic = OWS_WELCOME_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.err = err,
		.generation = c->layout->header.generation,
		.start_id = c->layout->header.start_id,
	};
	char bytes[sizeof(answer) + OWS_WHY];
	size_t len = printable_cut(why, OWS_WHY);
	const struct porter_order order = {
		.what = PORTER_SEND,
		.count = 1,
		.keep = 1,
		.slot = PORTER_NO_SLOT,
		.fds = {p->fd},
		.bytes = {bytes, sizeof(answer) + len},
	};

	memcpy(bytes, &answer, sizeof(answer));
	memcpy(bytes + sizeof(answer), why, len);
	/* as long as the porter has no time the program waits, and asks again at last */
	porter_give(c->porter, PORTER_AWAY, &order);
}
