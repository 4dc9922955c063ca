/* SPDX-License-Identifier: MIT */
/* Tests of edits of a configuration, key by key. */
#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/config/edit/commit.h"
#include "src/config/edit/edit.h"
#include "src/config/edit/edit_block.h"
#include "src/config/edit/edit_device.h"
#include "src/config/edit/replace.h"
#include "src/config/read/load.h"
#include "tests/unit/aid/said.h"

static struct rio *rio;
static char directory[64], file[96];

void setUp(void)
{
	said_begin();
	rio = NULL;
	strcpy(directory, "/tmp/test_config_edit.XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(directory));
	snprintf(file, sizeof(file), "%s/house.rio", directory);
}

static unsigned entries(bool remove)
{
	DIR *dir = opendir(directory);
	struct dirent *entry;
	unsigned count = 0;
	char path[400];

	while (dir && (entry = readdir(dir))) {
		if (entry->d_name[0] == '.')
			continue;
		count++;
		snprintf(path, sizeof(path), "%s/%s", directory, entry->d_name);
		if (remove)
			unlink(path);
	}
	if (dir)
		closedir(dir);
	return count;
}

void tearDown(void)
{
	rio_free(rio);
	entries(true);
	rmdir(directory);
}

static void parse(const char *text)
{
	rio_free(rio);
	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", text, strlen(text), &report, &rio));
	TEST_ASSERT_EQUAL_STRING("", said);
}

static void expect_text(const char *text)
{
	TEST_ASSERT_EQUAL_STRING(text, rio->text);
}

static int set(const char *name, const char *setting)
{
	return edit_set(&rio, name, &setting, 1, &report);
}

static const char genuine[] = "OwsDrv {\n"
			      "  # the heating\n"
			      "  Timeout                 10\n"
			      "  ItemCount               2\n"
			      "  #Comment1 \"room\"\n"
			      "  #\"continued\"\n"
			      "  Item {\n"
			      "    Name                    \"room1\" # north\n"
			      "    Path                    \"/28.551DDF030000/temperature12\"\n"
			      "    IOType                  0x0018\n"
			      "    InitValue               \"22\"\n"
			      "  }\n"
			      "\n"
			      "  Item {\n"
			      "    Name                    \"relay\"\n"
			      "    Path                    \"/29.B89115000000/PIO.BYTE\"\n"
			      "    IOType                  0x0022\n"
			      "    InitValue               \"0\"\n"
			      "  }\n"
			      "}\n";

/* genuine with one piece replaced */
static const char *with(const char *piece, const char *by)
{
	static char text[2048];
	const char *at = strstr(genuine, piece);

	TEST_ASSERT_NOT_NULL(at);
	snprintf(text, sizeof(text), "%.*s%s%s", (int)(at - genuine), genuine, by,
	         at + strlen(piece));
	return text;
}

static void test_a_set_value_changes_its_bytes_only(void)
{
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("room1", "InitValue=-3.5"));
	expect_text(with("\"22\"", "\"-3.5\""));
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("room1", "Name=attic"));
	expect_text(with("\"room1\"", "\"attic\""));
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("OwsDrv", "Timeout=7.5"));
	expect_text(with("10\n", "7.5\n"));
}

static void test_type_direction_and_uncached_go_into_io_type(void)
{
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("relay", "Type=word"));
	expect_text(with("0x0022", "0x0025"));
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("relay", "IO=input"));
	expect_text(with("0x0022", "0x0012"));
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("room1", "Uncached=on"));
	expect_text(with("0x0018", "0x0118"));
	TEST_ASSERT_EQUAL_INT(0, set("room1", "Uncached=off"));
	expect_text(genuine);
	/* zeros before a number make it no octal one: this is an output */
	parse(with("0x0022", "0034"));
	TEST_ASSERT_EQUAL_INT(0, set("relay", "Type=bool"));
	expect_text(with("0x0022", "0x0021"));
}

static void test_a_key_that_is_new_stands_behind_the_others(void)
{
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("room1", "PerFactor=10"));
	expect_text(with("\"22\"\n", "\"22\"\n    PerFactor               10\n"));
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("OwsDrv", "Period=0.5"));
	expect_text(with("2\n", "2\n  Period                  0.5\n"));
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("relay", "SetAlarm=set_alarm=133333333"));
	expect_text(
		with("\"0\"\n", "\"0\"\n    SetAlarm                \"set_alarm=133333333\"\n"));
}

static void test_settings_are_applied_in_order_also_over_a_new_name(void)
{
	static const char *const settings[] = {"Name=x", "Type=bool", "InitValue=on"};

	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, edit_set(&rio, "relay", settings, 3, &report));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "\"x\"\n"));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "0x0021\n    InitValue               \"on\"\n"));
}

static void test_a_key_can_be_taken_out_so_that_it_is_not_defined(void)
{
	static const char *const keys[] = {"InitValue"}, *const none[] = {"PorAlarm"};

	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, edit_unset(&rio, "room1", keys, 1, &report));
	expect_text(with("    InitValue               \"22\"\n", ""));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_unset(&rio, "room1", none, 1, &report));
	TEST_ASSERT_EQUAL_STRING("error: \"room1\" has no key PorAlarm\n", said);
}

static void test_an_added_item_is_last_and_counted(void)
{
	static const char *const settings[] = {"Type=byte", "IO=output", "SafeValue=1"};

	parse(genuine);
	TEST_ASSERT_EQUAL_INT(
		0, edit_add(&rio, "new", "/29.B89115000000/PIO.1", settings, 3, &report));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "ItemCount               3\n"));
	TEST_ASSERT_NOT_NULL(strstr(rio->text,
	                            "\"0\"\n"
	                            "  }\n"
	                            "  Item {\n"
	                            "    Name                    \"new\"\n"
	                            "    Path                    \"/29.B89115000000/PIO.1\"\n"
	                            "    IOType                  0x0022\n"
	                            "    InitValue               \"\"\n"
	                            "    SafeValue               \"1\"\n"
	                            "  }\n"
	                            "}\n"));
}

static void test_added_and_removed_again_leaves_no_trace(void)
{
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, edit_add(&rio, "new", "/a/b", NULL, 0, &report));
	TEST_ASSERT_EQUAL_INT(0, edit_remove(&rio, "new", &report));
	expect_text(genuine);
}

static void test_a_removed_item_leaves_comments_and_is_no_longer_counted(void)
{
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, edit_remove(&rio, "room1", &report));
	TEST_ASSERT_NULL(strstr(rio->text, "room1"));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "  ItemCount               1\n"
	                                       "  #Comment1 \"room\"\n"
	                                       "  #\"continued\"\n"
	                                       "\n"
	                                       "  Item {\n"
	                                       "    Name                    \"relay\"\n"));
}

static void test_an_item_is_added_to_a_configuration_without_items(void)
{
	parse(edit_empty);
	TEST_ASSERT_EQUAL_INT(0, edit_add(&rio, "a", "/x/y", NULL, 0, &report));
	TEST_ASSERT_EQUAL_INT(0, edit_add(&rio, "b", "/x/z", NULL, 0, &report));
	TEST_ASSERT_EQUAL_INT(0, edit_commit(rio, file, NULL, &report));
	TEST_ASSERT_EQUAL_STRING("", said);
	/* in words, and without a count that has to be kept right */
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "    Path                    \"/x/z\"\n"
	                                       "    Type                    \"double\"\n"
	                                       "    IO                      \"input\"\n"
	                                       "  }\n"));
	TEST_ASSERT_NULL(strstr(rio->text, "ItemCount"));
}

static void test_the_words_of_the_dialog_lead_to_the_keys(void)
{
	static const char *const words[][2] = {
		{"Power-on Reset Alarm=por", "PorAlarm"},
		{"Latch Alarm=latch", "LatchAlarm"},
		{"Init. Value=1", "InitValue"},
	};
	char expected[64];

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++) {
		said_begin();
		parse(genuine);
		TEST_ASSERT_EQUAL_INT(-EINVAL, set("room1", words[i][0]));
		snprintf(expected, sizeof(expected), "; is it %s?", words[i][1]);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, expected), said);
	}
	said_begin();
}

/* Every edit there is, each of which makes lines or takes some out. */
static void edit_all(const char *text)
{
	static const char *const keys[] = {"InitValue"}, *const more[] = {"Type=byte", "IO=output"};
	char path[100] = "Path=/kitchen/";

	memset(path + strlen(path), 'p', 60);
	parse(text);
	TEST_ASSERT_EQUAL_INT(0, set("room1", path));
	TEST_ASSERT_EQUAL_INT(0, set("room1", "Alarm=off"));
	TEST_ASSERT_EQUAL_INT(0, edit_unset(&rio, "room1", keys, 1, &report));
	TEST_ASSERT_EQUAL_INT(0, set("OwsDrv", "Period=0.5"));
	TEST_ASSERT_EQUAL_INT(0, edit_add(&rio, "b", path + 5, more, 2, &report));
	TEST_ASSERT_EQUAL_INT(0, edit_remove(&rio, "relay", &report));
	TEST_ASSERT_EQUAL_INT(0, edit_commit(rio, file, NULL, &report));
	TEST_ASSERT_EQUAL_STRING("", said);
}

/* Each "\n" of text becomes line_end. */
static void with_line_ends(const char *text, const char *line_end, char *to)
{
	for (; *text; text++) {
		if (*text == '\n')
			to = stpcpy(to, line_end);
		else
			*to++ = *text;
	}
	*to = '\0';
}

static void test_every_edit_keeps_the_line_ends_of_the_file(void)
{
	static const char in_one_line[] =
		"OwsDrv {\n"
		"Item { Name \"room1\" Path \"/x/y\" Type byte InitValue \"\" }\n"
		"Item { Name \"relay\" Path \"/x/z\" Type byte } }\n";
	static const char *const texts[] = {genuine, in_one_line}, *const ends[] = {"\r\n", "\r"};
	char plain[4000], text[4000];

	for (size_t i = 0; i < 2; i++) {
		edit_all(texts[i]);
		TEST_ASSERT_NOT_NULL(strstr(rio->text, "p\"\n\"p"));
		TEST_ASSERT_LESS_THAN_size_t(sizeof(plain) / 2, rio->len);
		strcpy(plain, rio->text);
		for (size_t k = 0; k < 2; k++) {
			with_line_ends(texts[i], ends[k], text);
			edit_all(text);
			with_line_ends(plain, ends[k], text);
			expect_text(text);
		}
	}
}

static void test_what_cannot_be_edited_is_said(void)
{
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("none", "Type=byte"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("room1", "Typ=byte"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("room1", "Zebra=1"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("room1", "Type"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("room1", "Name=a\nb"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("OwsDrv", "Item=3"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_remove(&rio, "none", &report));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_add(&rio, "relay", "/a/b", NULL, 0, &report));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_add(&rio, "OwsDrv", "/a/b", NULL, 0, &report));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("relay", "Name=OwsDrv"));
	TEST_ASSERT_EQUAL_STRING(
		"error: there is no item \"none\"\n"
		"error: there is no key Typ; is it Type?\n"
		"error: there is no key Zebra\n"
		"error: \"Type\": expected KEY=VALUE\n"
		"error: Name: control characters are not allowed\n"
		"error: Item is a block and has no value\n"
		"error: there is no item \"none\"\n"
		"error: there is an item \"relay\" already\n"
		"error: no item can be named OwsDrv: that stands for the driver itself, "
		"whose keys are changed by config FILE set OwsDrv KEY=VALUE\n"
		"error: no item can be named OwsDrv: that stands for the driver itself, "
		"whose keys are changed by config FILE set OwsDrv KEY=VALUE\n",
		said);
	expect_text(genuine);
}

/* The first of two would be lost, and with it rights. */
static void test_a_key_that_stands_twice_is_changed_in_the_text_alone(void)
{
	static const char text[] = "OwsDrv {\n"
				   "  ControlAllow \"pump* user:root\"\n"
				   "  ControlAllow \"heat* group:root\"\n"
				   "  Timeout 10\n"
				   "}\n";
	const char *key = "ControlAllow";

	parse(text);
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("OwsDrv", "ControlAllow=light* user:root"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_unset(&rio, "OwsDrv", &key, 1, &report));
	TEST_ASSERT_EQUAL_STRING(
		"error: ControlAllow stands more than once: change it in the text\n"
		"error: ControlAllow stands more than once: change it in the text\n",
		said);
	expect_text(text);
	said_begin();
	parse("OwsDrv {\n  ControlAllow \"pump* user:root\"\n  Timeout 10\n}\n");
	TEST_ASSERT_EQUAL_INT(0, set("OwsDrv", "ControlAllow=light* user:root"));
	expect_text("OwsDrv {\n  ControlAllow \"light* user:root\"\n  Timeout 10\n}\n");
	TEST_ASSERT_EQUAL_INT(0, edit_unset(&rio, "OwsDrv", &key, 1, &report));
	expect_text("OwsDrv {\n  Timeout 10\n}\n");
}

static void read_back(const char *path, char *text, size_t size)
{
	FILE *in = fopen(path, "r");
	size_t len;

	TEST_ASSERT_NOT_NULL_MESSAGE(in, path);
	len = fread(text, 1, size - 1, in);
	text[len] = '\0';
	fclose(in);
}

static void test_a_result_that_is_no_configuration_never_reaches_the_file(void)
{
	char text[2048];

	TEST_ASSERT_EQUAL_INT(0, replace_file(file, genuine, strlen(genuine)));
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("relay", "InitValue=256"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_commit(rio, file, NULL, &report));
	TEST_ASSERT_NOT_NULL(strstr(said, "InitValue \"256\": the type byte cannot hold it"));
	read_back(file, text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING(genuine, text);
	TEST_ASSERT_EQUAL_UINT(1, entries(false));
}

static void test_a_target_or_a_bus_that_is_there_already_never_reaches_the_file(void)
{
	static const char bus[] = "OwsDrv { TargetName host\n"
				  "  Bus { Target host } Bus { Target \"HOST:4304\" } }\n";
	char text[2048];

	TEST_ASSERT_EQUAL_INT(0, replace_file(file, genuine, strlen(genuine)));
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("OwsDrv", "TargetName=host, HOST:4304"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_commit(rio, file, "OwsDrv", &report));
	TEST_ASSERT_NOT_NULL(strstr(said, "the target \"HOST:4304\" is given twice"));
	said_begin();
	parse(bus);
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_commit(rio, file, NULL, &report));
	TEST_ASSERT_NOT_NULL(strstr(said, "there is a Bus for \"HOST:4304\" already"));
	read_back(file, text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING(genuine, text);
}

static void test_a_replaced_file_keeps_its_mode_and_is_a_new_one(void)
{
	struct stat before, after;
	char text[16];

	TEST_ASSERT_EQUAL_INT(0, replace_file(file, "one", 3));
	TEST_ASSERT_EQUAL_INT(0, chmod(file, 0640));
	TEST_ASSERT_EQUAL_INT(0, stat(file, &before));
	TEST_ASSERT_EQUAL_INT(0, replace_file(file, "two", 3));
	TEST_ASSERT_EQUAL_INT(0, stat(file, &after));
	TEST_ASSERT_EQUAL_HEX(0640, after.st_mode & 07777);
	TEST_ASSERT_EQUAL_INT(before.st_uid, after.st_uid);
	TEST_ASSERT_EQUAL_INT(before.st_gid, after.st_gid);
	read_back(file, text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("two", text);
	TEST_ASSERT_EQUAL_UINT(1, entries(false));
}

static void test_a_symbolic_link_stays_and_its_target_is_replaced(void)
{
	struct stat status;
	char link[96], text[16];

	snprintf(link, sizeof(link), "%s/link.rio", directory);
	TEST_ASSERT_EQUAL_INT(0, replace_file(file, "one", 3));
	TEST_ASSERT_EQUAL_INT(0, symlink("house.rio", link));
	TEST_ASSERT_EQUAL_INT(0, replace_file(link, "two", 3));
	TEST_ASSERT_EQUAL_INT(0, lstat(link, &status));
	TEST_ASSERT_TRUE(S_ISLNK(status.st_mode));
	read_back(file, text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("two", text);
	TEST_ASSERT_EQUAL_INT(0, unlink(file));
	TEST_ASSERT_EQUAL_INT(-ENOENT, replace_file(link, "x", 1));
}

/* Nor is any other file that has such a name there. */
static void test_a_link_that_leads_elsewhere_takes_no_lock_from_another(void)
{
	char link[120], other[120], lock[140];
	int first, second;

	snprintf(link, sizeof(link), "%s/link.rio", directory);
	snprintf(other, sizeof(other), "%s/other.rio", directory);
	snprintf(lock, sizeof(lock), "%s.lock", other);
	TEST_ASSERT_EQUAL_INT(0, replace_file(file, "a", 1));
	TEST_ASSERT_EQUAL_INT(0, replace_file(other, "b", 1));
	TEST_ASSERT_EQUAL_INT(0, symlink(file, link));
	first = replace_lock(link);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, first);
	TEST_ASSERT_EQUAL_INT(0, unlink(link));
	TEST_ASSERT_EQUAL_INT(0, symlink(other, link));
	second = replace_lock(link);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, second);
	replace_unlock(link, first);
	TEST_ASSERT_EQUAL_INT(0, access(lock, F_OK));
	replace_unlock(link, second);
	TEST_ASSERT_EQUAL_INT(-1, access(lock, F_OK));
}

static void test_when_writing_fails_the_old_file_stays_and_nothing_is_left_over(void)
{
	struct rlimit limit, small;
	char text[16];
	int err;

	TEST_ASSERT_EQUAL_INT(0, replace_file(file, "one", 3));
	/* a limit on the size of files fails as a full disk does: in the middle of a write */
	TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_FSIZE, &limit));
	small = limit;
	small.rlim_cur = 100;
	signal(SIGXFSZ, SIG_IGN);
	TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_FSIZE, &small));
	err = replace_file(file, genuine, strlen(genuine));
	TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_FSIZE, &limit));
	signal(SIGXFSZ, SIG_DFL);
	TEST_ASSERT_EQUAL_INT(-EFBIG, err);
	read_back(file, text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("one", text);
	TEST_ASSERT_EQUAL_UINT(1, entries(false));
}

static void test_only_plain_files_are_replaced(void)
{
	TEST_ASSERT_EQUAL_INT(-EISDIR, replace_file(directory, "x", 1));
	TEST_ASSERT_EQUAL_INT(-EINVAL, replace_file("/dev/null", "x", 1));
	TEST_ASSERT_EQUAL_INT(-ENOENT, replace_file("/nonexistent/dir/x.rio", "x", 1));
}

static void test_only_who_may_replace_the_file_can_open_its_lock(void)
{
	char lock[sizeof(file) + 8];
	struct stat st;
	int fd;

	snprintf(lock, sizeof(lock), "%s.lock", file);
	for (int shared = 0; shared < 2; shared++) {
		TEST_ASSERT_EQUAL_INT(0, chmod(directory, shared ? 0770 : 0755));
		fd = edit_lock(file, &report);
		TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fd);
		TEST_ASSERT_EQUAL_INT(0, stat(lock, &st));
		TEST_ASSERT_EQUAL_HEX(S_IFREG | (shared ? 0660 : 0600), st.st_mode);
		replace_unlock(file, fd);
		TEST_ASSERT_EQUAL_INT(-1, stat(lock, &st));
	}
	/* a name that leads elsewhere is not followed, and what is there keeps its owner */
	TEST_ASSERT_EQUAL_INT(0, symlink("/dev/null", lock));
	TEST_ASSERT_EQUAL_INT(-ELOOP, replace_lock(file));
	TEST_ASSERT_EQUAL_INT(0, unlink(lock));
}

static void test_a_bus_block_is_made_changed_and_removed_by_its_target(void)
{
	static const char made[] = "  Bus {\n"
				   "    Target                  \"i2c:auto\"\n"
				   "    PowerOffMs              700\n"
				   "  }\n"
				   "}\n";
	const char *const twice[] = {"Target=host", "Touch=on"};

	parse(genuine);
	TEST_ASSERT_EQUAL_INT(0, set("Bus:i2c:auto", "PowerOffMs=700"));
	TEST_ASSERT_EQUAL_STRING(made, rio->text + strlen(rio->text) - strlen(made));
	TEST_ASSERT_EQUAL_INT(0, edit_set(&rio, "Bus:i2c:auto", twice, 2, &report));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "\"host\"\n"));
	/* another spelling of the same target */
	TEST_ASSERT_EQUAL_INT(0, edit_unset(&rio, "Bus:owserver:host:4304",
	                                    (const char *const[]){"Touch"}, 1, &report));
	TEST_ASSERT_NULL(strstr(rio->text, "Touch"));
	TEST_ASSERT_EQUAL_INT(0, edit_remove(&rio, "Bus:host", &report));
	expect_text(genuine);
	TEST_ASSERT_EQUAL_STRING("", said);
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_remove(&rio, "Bus:host", &report));
	TEST_ASSERT_NOT_NULL(strstr(said, "there is no Bus for \"host\""));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("Bus:host", "Unit=K"));
	TEST_ASSERT_NOT_NULL(strstr(said, "there is no key Unit"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_remove(&rio, "OwsDrv", &report));
	TEST_ASSERT_NOT_NULL(strstr(said, "OwsDrv cannot be removed"));
}

static int replace(const char *before, const char *after, const char *location)
{
	uint8_t old[ROM_LEN], new[ROM_LEN];

	TEST_ASSERT_EQUAL_INT(0, rom_parse(before, strlen(before), old));
	TEST_ASSERT_EQUAL_INT(0, rom_parse(after, strlen(after), new));
	return edit_replace(&rio, old, new, location, &report);
}

static void test_a_replaced_device_changes_the_paths_of_its_items_only(void)
{
	static const char two[] = "OwsDrv {\n"
				  "  Item { Name \"a\" # warm\n"
				  "    Path \"/28.551DDF030000/temperature\" Unit \"K\" }\n"
				  "  Item { Name b Path \"/bus.1/28551ddf030000/power\" }\n"
				  "}\n";

	parse(two);
	TEST_ASSERT_EQUAL_INT(0, replace("28.551DDF030000", "28.67C6697351FF", "bus.0"));
	expect_text("OwsDrv {\n"
	            "  Item { Name \"a\" # warm\n"
	            "    Path \"/28.67C6697351FF/temperature\" Unit \"K\" "
	            "Identity                \"/28.551DDF030000/temperature\" }\n"
	            "  Item { Name b Path \"/bus.0/2867C6697351FF/power\" "
	            "Identity                \"/bus.1/28551ddf030000/power\" }\n"
	            "}\n");
	TEST_ASSERT_EQUAL_INT(0, replace("28.67C6697351FF", "28.551DDF030000", ""));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "/bus.0/28551DDF030000/power"));
	TEST_ASSERT_EQUAL_STRING("", said);
}

static void test_items_of_one_path_keep_their_identities_when_the_device_is_replaced(void)
{
	const char *second = "Identity                \"/28.551DDF030000/power#2\"";

	parse("OwsDrv {\n"
	      "Item { Name a Path /uncached/28.551DDF030000/power }\n"
	      "Item { Name b Path /28.551DDF030000/power }\n"
	      "Item { Name c Path /28.551DDF030000/power Identity \"/old\" }\n"
	      "}\n");
	TEST_ASSERT_EQUAL_INT(0, replace("28.551DDF030000", "28.67C6697351FF", ""));
	TEST_ASSERT_NOT_NULL(
		strstr(rio->text, "Identity                \"/28.551DDF030000/power\""));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, second));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "Identity \"/old\""));
	/* the next replacement changes none */
	TEST_ASSERT_EQUAL_INT(0, replace("28.67C6697351FF", "28.000000000001", ""));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, second));
	TEST_ASSERT_NULL(strstr(strstr(rio->text, second) + 1, second));
	TEST_ASSERT_NULL(strstr(rio->text, "67C6697351FF"));
}

#define THREE \
	"OwsDrv {\n" \
	"Item {\nName a\nPath /x/y\nType double\n}\n" \
	"Item {\nName b\nPath /x/y\nType double\n}\n" \
	"Item {\nName c\nPath /x/y\nType double\n}\n" \
	"}\n"

/* The Identity of the item; "": it has none. */
static const char *identity_of(const char *name)
{
	const struct rio_node *item = edit_item(rio, name);
	const struct rio_node *node = item ? rio_child(item, "Identity") : NULL;

	return node ? node->value : "";
}

static void expect_identities(const char *a, const char *b, const char *c)
{
	TEST_ASSERT_EQUAL_STRING(a, identity_of("a"));
	TEST_ASSERT_EQUAL_STRING(b, identity_of("b"));
	TEST_ASSERT_EQUAL_STRING(c, identity_of("c"));
	TEST_ASSERT_EQUAL_STRING("", said);
}

static void test_an_item_that_stays_has_the_same_identity_after_every_edit(void)
{
	static const char *const key[] = {"Identity"};
	static const char *const others[] = {"Path=/q/y", "Identity=/x/y#3"};

	parse(THREE);
	TEST_ASSERT_EQUAL_INT(0, edit_remove(&rio, "a", &report));
	expect_identities("", "/x/y#2", "/x/y#3");
	parse(THREE);
	TEST_ASSERT_EQUAL_INT(0, edit_remove(&rio, "c", &report));
	expect_identities("", "", "");

	parse(THREE);
	TEST_ASSERT_EQUAL_INT(0, edit_move(&rio, "a", "b", true, &report));
	expect_identities("", "/x/y#2", "");
	parse(THREE);
	TEST_ASSERT_EQUAL_INT(0, edit_move(&rio, "c", "a", false, &report));
	expect_identities("", "", "/x/y#3");

	parse(THREE);
	TEST_ASSERT_EQUAL_INT(0, set("b", "Path=/q/y"));
	expect_identities("", "/x/y#2", "");
	TEST_ASSERT_EQUAL_INT(0, set("b", "Path=/r/y"));
	expect_identities("", "/x/y#2", "");
	/* what is given by hand stays, and is refused where another has it */
	parse(THREE);
	TEST_ASSERT_EQUAL_INT(0, edit_set(&rio, "b", others, 2, &report));
	expect_identities("", "/x/y#3", "/x/y#3");
	/* without it the item is counted after those that have theirs */
	parse(THREE);
	TEST_ASSERT_EQUAL_INT(0, set("a", "Identity=/o/y"));
	expect_identities("/o/y", "/x/y#2", "/x/y#3");
	TEST_ASSERT_EQUAL_INT(0, edit_unset(&rio, "b", key, 1, &report));
	expect_identities("/o/y", "", "/x/y#3");
}

static void test_an_identity_is_written_only_where_it_would_change(void)
{
	static const char *const path[] = {"Path"};

	parse(THREE);
	TEST_ASSERT_EQUAL_INT(0, set("a", "Path=/uncached/x/y"));
	TEST_ASSERT_EQUAL_INT(0, set("b", "Name=d"));
	TEST_ASSERT_EQUAL_INT(0, set("c", "Unit=K"));
	TEST_ASSERT_EQUAL_INT(0, edit_add(&rio, "e", "/x/y", NULL, 0, &report));
	TEST_ASSERT_NULL(strstr(rio->text, "Identity"));
	/* a new item has none that stays */
	TEST_ASSERT_EQUAL_INT(
		0, edit_add(&rio, "f", "/x/y", (const char *const[]){"Path=/q/y"}, 1, &report));
	TEST_ASSERT_NULL(strstr(rio->text, "Identity"));
	TEST_ASSERT_EQUAL_INT(0, edit_unset(&rio, "e", path, 1, &report));
	TEST_ASSERT_NULL(strstr(rio->text, "Identity"));
}

/* What the item called so, the last one, is known by in the end. */
static void expect_last_identity(const char *name, const char *identity)
{
	struct config *config;

	TEST_ASSERT_EQUAL_INT(0, config_parse("f", rio->text, rio->len, &report, &config));
	TEST_ASSERT_EQUAL_STRING(name, config->items[config->item_count - 1].name);
	TEST_ASSERT_EQUAL_STRING(identity, config->items[config->item_count - 1].identity);
	config_free(config);
}

static void test_what_has_the_path_of_a_removed_item_is_that_signal_again(void)
{
	static const char *const apart[] = {"Identity=/x/y#oven"};

	parse(THREE);
	TEST_ASSERT_EQUAL_INT(0, edit_remove(&rio, "a", &report));
	TEST_ASSERT_EQUAL_INT(0, edit_add(&rio, "again", "/x/y", NULL, 0, &report));
	expect_last_identity("again", "/x/y");
	TEST_ASSERT_EQUAL_INT(0, edit_remove(&rio, "again", &report));
	TEST_ASSERT_EQUAL_INT(0, edit_add(&rio, "oven", "/x/y", apart, 1, &report));
	expect_last_identity("oven", "/x/y#oven");
}

static void test_a_replacement_that_cannot_be_meant_is_refused(void)
{
	parse(genuine);
	TEST_ASSERT_EQUAL_INT(-EINVAL, replace("28.000000000001", "28.67C6697351FF", ""));
	TEST_ASSERT_NOT_NULL(strstr(said, "no item has the device 28.000000000001"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, replace("28.551DDF030000", "29.B89115000000", ""));
	TEST_ASSERT_NOT_NULL(strstr(said, "the device 29.B89115000000 has items already"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, replace("28.551DDF030000", "10.67C6697351FF", ""));
	TEST_ASSERT_NOT_NULL(strstr(said, "different families"));
	expect_text(genuine);
}

static void test_a_device_with_more_items_than_any_has_is_not_replaced(void)
{
	static char many[64 + (EDIT_REPLACE_MAX + 1) * 40] = "OwsDrv {\n";

	for (int i = 0; i < EDIT_REPLACE_MAX; i++)
		strcat(many, "Item { Path /28.551DDF030000/power }\n");
	strcat(many, "# }\n}\n");
	parse(many);
	TEST_ASSERT_EQUAL_INT(0, replace("28.551DDF030000", "28.67C6697351FF", ""));
	memcpy(strrchr(many, '#'), "Item { Path /28.551DDF030000/power }\n}\n", 40);
	parse(many);
	TEST_ASSERT_EQUAL_INT(-EINVAL, replace("28.551DDF030000", "28.67C6697351FF", ""));
	TEST_ASSERT_NOT_NULL(strstr(said, "more than 256 items have the device 28.551DDF030000"));
	TEST_ASSERT_NULL(strstr(rio->text, "28.67C6697351FF"));
}

static void test_a_rename_takes_along_what_names_the_item(void)
{
	static const char before[] =
		"# the plant\n"
		"OwsDrv {\n"
		"  ControlAllow \"heat user:root\" # of the boiler\n"
		"  ControlAllow \"heat* user:root\"\n"
		"  ControlAllow \"pump group:root\"\n"
		"  Item { # first\n"
		"    Name heat\n"
		"    Path /05.000000000001/PIO Type bool IO output # relay\n"
		"    LimitH 0.5\n"
		"  }\n"
		"  Item { Name pump Path /05.000000000002/PIO Type bool IO output }\n"
		"  ControlAllow \"heat group:root\"\n"
		"}\n";
	static const char after[] =
		"# the plant\n"
		"OwsDrv {\n"
		"  ControlAllow \"boiler user:root\" # of the boiler\n"
		"  ControlAllow \"heat* user:root\"\n"
		"  ControlAllow \"pump group:root\"\n"
		"  Item { # first\n"
		"    Name boiler\n"
		"    Path /05.000000000001/PIO Type bool IO output # relay\n"
		"    LimitH 0.5\n"
		"  }\n"
		"  Item { Name pump Path /05.000000000002/PIO Type bool IO output }\n"
		"  ControlAllow \"boiler group:root\"\n"
		"}\n";

	parse(before);
	TEST_ASSERT_EQUAL_INT(0, edit_rename(&rio, "heat", "boiler", &report));
	TEST_ASSERT_EQUAL_STRING(after, rio->text);
	TEST_ASSERT_EQUAL_STRING(
		"warning: ControlAllow \"heat* user:root\" fits heat and not boiler: "
		"look who may set it now\n",
		said);
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_rename(&rio, "boiler", "pump", &report));
	TEST_ASSERT_NOT_NULL(strstr(said, "there is an item \"pump\" already"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_rename(&rio, "heat", "x", &report));
	TEST_ASSERT_NOT_NULL(strstr(said, "there is no item \"heat\""));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_rename(&rio, "boiler", "OwsDrv", &report));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit_rename(&rio, "OwsDrv", "x", &report));
	TEST_ASSERT_EQUAL_STRING(after, rio->text);
	/* set with Name is the same, as the page uses it; a name within another stays */
	said_begin();
	TEST_ASSERT_EQUAL_INT(0, set("boiler", "Name=boile"));
	TEST_ASSERT_EQUAL_INT(0, set("boile", "Name=heat"));
	TEST_ASSERT_EQUAL_STRING(before, rio->text);
}

static void test_a_rename_warns_of_each_right_that_it_changes(void)
{
	parse("OwsDrv {\n"
	      "  ControlAllow \"boiler user:root\"\n"
	      "  ControlAllow \"heat user:root\"\n"
	      "  Item { Name heat Path /05.000000000001/PIO Type bool IO output }\n"
	      "}\n");
	TEST_ASSERT_EQUAL_INT(0, edit_rename(&rio, "heat", "boiler", &report));
	TEST_ASSERT_NOT_NULL(strstr(said, "\"boiler user:root\" fits boiler and not heat"));
	/* a name that is a pattern would give the right to others, or to nobody */
	said_begin();
	TEST_ASSERT_EQUAL_INT(0, edit_rename(&rio, "boiler", "boiler[1]", &report));
	TEST_ASSERT_NOT_NULL(strstr(said, "\"boiler user:root\" fits boiler and not boiler[1]"));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "ControlAllow \"boiler user:root\""));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_set_value_changes_its_bytes_only);
	RUN_TEST(test_type_direction_and_uncached_go_into_io_type);
	RUN_TEST(test_a_key_that_is_new_stands_behind_the_others);
	RUN_TEST(test_settings_are_applied_in_order_also_over_a_new_name);
	RUN_TEST(test_a_key_can_be_taken_out_so_that_it_is_not_defined);
	RUN_TEST(test_an_added_item_is_last_and_counted);
	RUN_TEST(test_added_and_removed_again_leaves_no_trace);
	RUN_TEST(test_a_removed_item_leaves_comments_and_is_no_longer_counted);
	RUN_TEST(test_an_item_is_added_to_a_configuration_without_items);
	RUN_TEST(test_every_edit_keeps_the_line_ends_of_the_file);
	RUN_TEST(test_what_cannot_be_edited_is_said);
	RUN_TEST(test_a_key_that_stands_twice_is_changed_in_the_text_alone);
	RUN_TEST(test_a_result_that_is_no_configuration_never_reaches_the_file);
	RUN_TEST(test_a_target_or_a_bus_that_is_there_already_never_reaches_the_file);
	RUN_TEST(test_a_replaced_file_keeps_its_mode_and_is_a_new_one);
	RUN_TEST(test_a_symbolic_link_stays_and_its_target_is_replaced);
	RUN_TEST(test_a_link_that_leads_elsewhere_takes_no_lock_from_another);
	RUN_TEST(test_when_writing_fails_the_old_file_stays_and_nothing_is_left_over);
	RUN_TEST(test_only_plain_files_are_replaced);
	RUN_TEST(test_only_who_may_replace_the_file_can_open_its_lock);
	RUN_TEST(test_a_bus_block_is_made_changed_and_removed_by_its_target);
	RUN_TEST(test_a_replaced_device_changes_the_paths_of_its_items_only);
	RUN_TEST(test_items_of_one_path_keep_their_identities_when_the_device_is_replaced);
	RUN_TEST(test_an_item_that_stays_has_the_same_identity_after_every_edit);
	RUN_TEST(test_an_identity_is_written_only_where_it_would_change);
	RUN_TEST(test_what_has_the_path_of_a_removed_item_is_that_signal_again);
	RUN_TEST(test_a_replacement_that_cannot_be_meant_is_refused);
	RUN_TEST(test_a_device_with_more_items_than_any_has_is_not_replaced);
	RUN_TEST(test_the_words_of_the_dialog_lead_to_the_keys);
	RUN_TEST(test_a_rename_takes_along_what_names_the_item);
	RUN_TEST(test_a_rename_warns_of_each_right_that_it_changes);
	return UNITY_END();
}
