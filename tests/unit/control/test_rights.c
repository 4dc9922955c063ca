/* SPDX-License-Identifier: MIT */
/* Who may command what, as a table; and that the control room keeps to it. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/control/rights.h"
#include "tests/unit/aid/control_scene.h"

enum {
	ROOT = 0,
	OWN = 100,
	PLC = 200,
	STRANGER = 300,
	CONTROLLERS = 400,
	READERS = 401,
	CONFIGURERS = 403,
	OPS = 402
};

static struct config_holder plc = {.id = PLC}, ops = {.group = true, .id = OPS};
static struct config_allow allows[] = {
	{.pattern = "pump_*", .holders = &plc, .holder_count = 1},
	{.pattern = "pump_2", .holders = &ops, .holder_count = 1},
	{.pattern = "nobody?", .holder_count = 0},
};
static struct config_item items[] = {{.name = "pump_1"}, {.name = "pump_2"}, {.name = "valve"}};
static struct config with = {.allows = allows, .allow_count = 3, .items = items, .item_count = 3},
		     without = {.items = items, .item_count = 3};

void setUp(void)
{
}

void tearDown(void)
{
	control_close();
}

static struct rights of(const struct config *config, bool service)
{
	return (struct rights){
		.config = config,
		.own = OWN,
		.has_controllers = service,
		.has_readers = service,
		.has_configurers = service,
		.controllers = CONTROLLERS,
		.readers = READERS,
		.configurers = CONFIGURERS,
	};
}

static struct peer peer_of(uid_t uid, gid_t gid)
{
	return (struct peer){.uid = uid, .gid = gid};
}

static void test_without_ControlAllow_the_group_decides(void)
{
	struct rights service = of(&without, true), user = of(&without, false);
	gid_t groups[] = {1, CONTROLLERS};
	struct peer root = peer_of(ROOT, 0), own = peer_of(OWN, OWN), plain = peer_of(STRANGER, 5),
		    first = peer_of(STRANGER, CONTROLLERS), other = peer_of(STRANGER, 5);

	other.groups = groups;
	other.group_count = 2;
	TEST_ASSERT_TRUE(rights_set(&service, &root, "valve"));
	TEST_ASSERT_TRUE(rights_set(&service, &own, "valve"));
	TEST_ASSERT_TRUE(rights_set(&service, &first, "valve"));
	TEST_ASSERT_TRUE(rights_set(&service, &other, "valve"));
	TEST_ASSERT_TRUE(rights_set(&service, &other, ""));
	TEST_ASSERT_FALSE(rights_set(&service, &plain, "valve"));
	TEST_ASSERT_FALSE(rights_set_any(&service, &plain));
	/* of a user's owsd the groups do not count */
	TEST_ASSERT_TRUE(rights_set(&user, &root, "valve"));
	TEST_ASSERT_TRUE(rights_set(&user, &own, "valve"));
	TEST_ASSERT_FALSE(rights_set(&user, &first, "valve"));
	TEST_ASSERT_FALSE(rights_set_any(&user, &other));
}

static void test_ControlAllow_names_who_may_command_the_signals_of_a_pattern(void)
{
	static const struct {
		uid_t uid;
		gid_t gid;
		const char *name;
		bool may;
	} rows[] = {
		{PLC, 1, "pump_1", true},
		{PLC, 1, "pump_2", true},
		{PLC, 1, "valve", false},
		{PLC, 1, "", false},
		{STRANGER, OPS, "pump_1", false},
		{STRANGER, OPS, "pump_2", true},
		{STRANGER, OPS, "valve", false},
		/* a signal that an entry names is no longer the group's */
		{STRANGER, CONTROLLERS, "pump_1", false},
		{STRANGER, CONTROLLERS, "pump_2", false},
		{STRANGER, CONTROLLERS, "valve", true},
		{STRANGER, CONTROLLERS, "", true},
		{STRANGER, CONTROLLERS, "nobody1", false},
		{STRANGER, CONTROLLERS, "nobody12", true},
		{ROOT, 1, "nobody1", true},
		{OWN, 1, "nobody1", true},
	};
	struct rights rights = of(&with, true);

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct peer peer = peer_of(rows[i].uid, rows[i].gid);

		TEST_ASSERT_EQUAL_MESSAGE(rows[i].may, rights_set(&rights, &peer, rows[i].name),
		                          rows[i].name);
	}
}

static void test_the_rights_of_a_controller_are_a_bit_for_each_record(void)
{
	struct rights rights = of(&with, true);
	struct peer peer = peer_of(PLC, 1), group = peer_of(STRANGER, CONTROLLERS);
	uint32_t bits[1] = {0};

	TEST_ASSERT_EQUAL_UINT(2, rights_fill(&rights, &peer, bits));
	TEST_ASSERT_EQUAL_HEX32(0x6, bits[0]);
	bits[0] = 0;
	TEST_ASSERT_EQUAL_UINT(1, rights_fill(&rights, &group, bits));
	TEST_ASSERT_EQUAL_HEX32(0x9, bits[0]);
}

static void test_readers_may_hear_of_news_and_command_nothing(void)
{
	struct rights rights = of(&with, true);
	struct peer reader = peer_of(STRANGER, READERS), plain = peer_of(STRANGER, 5);

	TEST_ASSERT_TRUE(rights_read(&rights, &reader));
	TEST_ASSERT_FALSE(rights_set_any(&rights, &reader));
	TEST_ASSERT_FALSE(rights_read(&rights, &plain));
}

static void test_a_reload_is_for_root_for_owsds_user_and_for_a_group_of_its_own(void)
{
	struct rights service = of(&with, true), user = of(&with, false);
	struct peer root = peer_of(ROOT, 0), own = peer_of(OWN, OWN),
		    group = peer_of(STRANGER, CONFIGURERS),
		    controller = peer_of(STRANGER, CONTROLLERS), reader = peer_of(PLC, READERS);

	TEST_ASSERT_TRUE(rights_reload(&service, &root));
	TEST_ASSERT_TRUE(rights_reload(&service, &own));
	TEST_ASSERT_TRUE(rights_reload(&service, &group));
	TEST_ASSERT_FALSE(rights_reload(&service, &controller));
	TEST_ASSERT_FALSE(rights_reload(&service, &reader));
	TEST_ASSERT_FALSE(rights_reload(&user, &group));
	TEST_ASSERT_TRUE(rights_reload(&user, &own));
	/* and it gives no other right */
	TEST_ASSERT_FALSE(rights_set_any(&service, &group));
	TEST_ASSERT_FALSE(rights_read(&service, &group));
}

static void test_a_stranger_is_refused_and_takes_no_place(void)
{
	if (getuid())
		TEST_IGNORE_MESSAGE("only root can be another user");
	control_config.allows = allows;
	control_config.allow_count = 3;
	control_open();
	TEST_ASSERT_EQUAL(-EACCES, control_join_as(STRANGER, NULL, 0, OWS_HELLO_COMMAND));
	TEST_ASSERT_EQUAL(-EACCES, control_join_as(STRANGER, NULL, 0, 0));
	TEST_ASSERT_EQUAL_UINT(0, control_count("control_connections"));
	TEST_ASSERT_EQUAL_UINT(2, control_count("control_refused_rights"));
	TEST_ASSERT_EQUAL(0, control_join_as(PLC, NULL, 0, OWS_HELLO_COMMAND));
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(1, control_joined());
}

static void test_the_other_groups_of_a_process_count(void)
{
	const gid_t groups[] = {1, 2, 3, OPS};

	if (getuid())
		TEST_IGNORE_MESSAGE("only root can be another user");
	control_config.allows = allows;
	control_config.allow_count = 3;
	control_open();
	TEST_ASSERT_EQUAL(0, control_join_as(STRANGER, groups, 4, OWS_HELLO_COMMAND));
	TEST_ASSERT_EQUAL(-EACCES, control_join_as(STRANGER, groups, 3, OWS_HELLO_COMMAND));
}

/* The rights are those of the process that connected: a memory that is handed on carries them. */
static void test_the_memory_shows_what_its_controller_may_command(void)
{
	struct control_client client;
	const struct ows_command_slot *slots;

	control_config.allows = allows;
	control_config.allow_count = 3;
	control_open();
	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "own"));
	slots = (const void *)(client.memory +
	                       ((struct ows_controller_header *)(void *)client.memory)->slot_off);
	for (int i = 0; i < 4; i++)
		TEST_ASSERT_EQUAL_UINT(1, slots[i].allowed);
	control_leave(&client);
	TEST_ASSERT_EQUAL(0, control_join(&client, 0, "own, for news"));
	slots = (const void *)(client.memory +
	                       ((struct ows_controller_header *)(void *)client.memory)->slot_off);
	for (int i = 0; i < 4; i++)
		TEST_ASSERT_EQUAL_UINT(0, slots[i].allowed);
	TEST_ASSERT_EQUAL_HEX32(0, control_message_of(client.welcome.serial)->controller.rights[0]);
	control_close(); /* whose thread frees the rights of one that has left, at any time */
	control_leave(&client);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_without_ControlAllow_the_group_decides);
	RUN_TEST(test_ControlAllow_names_who_may_command_the_signals_of_a_pattern);
	RUN_TEST(test_the_rights_of_a_controller_are_a_bit_for_each_record);
	RUN_TEST(test_readers_may_hear_of_news_and_command_nothing);
	RUN_TEST(test_a_reload_is_for_root_for_owsds_user_and_for_a_group_of_its_own);
	RUN_TEST(test_a_stranger_is_refused_and_takes_no_place);
	RUN_TEST(test_the_other_groups_of_a_process_count);
	RUN_TEST(test_the_memory_shows_what_its_controller_may_command);
	return UNITY_END();
}
