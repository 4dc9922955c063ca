/* SPDX-License-Identifier: MIT */
/* How often users connect: an account for each of those that have connected last. */
#include "src/memory/control/often.h"
#include "hal/base/time.h"

#define COST_NS (NS_PER_S / OFTEN_S)

bool often_is_too(struct often *often, uid_t uid, int64_t now_ns)
{
	unsigned at = 0;

	for (unsigned i = 0; i < OFTEN_USERS; i++) {
		if (often->users[i].uid == uid) {
			at = i;
			break;
		}
		/* the one that has used least makes room for another user */
		if (often->users[i].until_ns < often->users[at].until_ns)
			at = i;
	}
	if (often->users[at].uid != uid || often->users[at].until_ns < now_ns)
		often->users[at].until_ns = now_ns;
	often->users[at].uid = uid;
	if (often->users[at].until_ns - now_ns >= OFTEN_ROW * COST_NS)
		return true;
	often->users[at].until_ns += COST_NS;
	return false;
}
