/* SPDX-License-Identifier: MIT */
/* What a controller gets of a generation: its memory and its rights. */
#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

#include "src/memory/control/grant.h"
#include "src/memory/control/sealed.h"

int grant_make(struct control_grant *grant, const struct controller_layout *layout,
               const struct rights *rights, const struct control_seat *seat)
{
	*grant = (struct control_grant){
		.memory.layout = layout,
		.size = layout->header.size,
		.rights = calloc((size_t)layout->header.slot_count / 32 + 1, sizeof(uint32_t)),
		.memfd = -1,
		.own = -1,
	};
	if (!grant->rights)
		return -ENOMEM;
	grant->memfd = sealed_make(grant->size, &grant->memory.base, &grant->own);
	if (grant->memfd < 0) {
		int err = grant->memfd;

		grant->memfd = grant->own = -1;
		grant->memory.base = NULL;
		grant_free(grant);
		return err;
	}
	if (seat->commands)
		grant->allowed = rights_fill(rights, &seat->peer, grant->rights);
	controller_build(&grant->memory, seat->who.serial);
	for (uint32_t i = 0; i < layout->header.slot_count; i++)
		controller_allow(&grant->memory, i, grant->rights[i / 32] >> i % 32 & 1);
	controller_state(&grant->memory, OWS_STATE_LIVE);
	return 0;
}

void grant_free(struct control_grant *grant)
{
	sealed_unmap(grant->memory.base, grant->size);
	if (grant->memory.base && grant->memfd >= 0)
		close(grant->memfd);
	if (grant->memory.base && grant->own >= 0)
		close(grant->own);
	free(grant->rights);
	*grant = (struct control_grant){.memfd = -1, .own = -1};
}
