/* SPDX-License-Identifier: MIT */
/*
 * The layout of major version 2, field by field: offset and size in bytes. Programs in other
 * languages are written against these numbers. A new field is added here too; no line is changed.
 */
#include "unity.h"

#include "src/public/ows_layout.h"

void setUp(void)
{
}

void tearDown(void)
{
}

#define AT(what, field, offset, size) \
	_Static_assert(offsetof(struct what, field) == (offset) && \
	                       sizeof(((struct what *)0)->field) == (size), \
	               #what "." #field)

AT(ows_sample, value, 0, 8);
AT(ows_sample, measured_ns, 8, 8);
AT(ows_sample, tried_ns, 16, 8);
AT(ows_sample, err, 24, 4);
AT(ows_sample, quality, 28, 1);
AT(ows_sample, detail, 29, 1);
AT(ows_sample, target, 30, 1);
AT(ows_sample, flags, 31, 1);
AT(ows_sample, count, 32, 4);
AT(ows_sample, confirmed, 36, 4);
AT(ows_sample, len, 40, 4);
AT(ows_sample, check, 44, 4);

AT(ows_attrs, transactions, 0, 8);
AT(ows_attrs, update_ns, 8, 8);
AT(ows_attrs, age_max_ns, 16, 8);
AT(ows_attrs, commanded, 24, 8);
AT(ows_attrs, raw, 32, 8);
AT(ows_attrs, per_base, 40, 4);
AT(ows_attrs, per_max, 44, 4);
AT(ows_attrs, pend_base, 48, 4);
AT(ows_attrs, pend_last, 52, 4);
AT(ows_attrs, pend_max, 56, 4);
AT(ows_attrs, alarms, 60, 4);
AT(ows_attrs, flags, 64, 4);
AT(ows_attrs, limit_state, 68, 1);
AT(ows_attrs, limit_condition, 69, 1);
AT(ows_attrs, shelved, 70, 1);
AT(ows_attrs, check, 76, 4);

AT(ows_slot, sample, 0, 48);
AT(ows_slot, attrs, 48, 80);

AT(ows_record, seq, 0, 4);
AT(ows_record, text_off, 4, 4);
AT(ows_record, type, 8, 1);
AT(ows_record, flags, 9, 1);
AT(ows_record, text_cap, 10, 2);
AT(ows_record, slot, 16, 256);

AT(ows_info_entry, name_off, 0, 4);
AT(ows_info_entry, path_off, 4, 4);
AT(ows_info_entry, per_factor, 8, 4);
AT(ows_info_entry, line, 12, 4);
AT(ows_info_entry, stale_after_ns, 16, 8);
AT(ows_info_entry, init_value, 24, 8);
AT(ows_info_entry, safe_value, 32, 8);
AT(ows_info_entry, flags, 40, 4);
AT(ows_info_entry, unit_off, 44, 4);
AT(ows_info_entry, description_off, 48, 4);
AT(ows_info_entry, family_off, 52, 4);
AT(ows_info_entry, device_off, 56, 4);
AT(ows_info_entry, calibrated_off, 60, 4);
AT(ows_info_entry, points_off, 64, 4);
AT(ows_info_entry, decimals, 68, 4);
AT(ows_info_entry, scale, 72, 8);
AT(ows_info_entry, offset, 80, 8);
AT(ows_info_entry, min, 88, 8);
AT(ows_info_entry, max, 96, 8);
AT(ows_info_entry, limit_hh, 104, 8);
AT(ows_info_entry, limit_h, 112, 8);
AT(ows_info_entry, limit_l, 120, 8);
AT(ows_info_entry, limit_ll, 128, 8);
AT(ows_info_entry, filter_s, 136, 8);
AT(ows_info_entry, deadband, 144, 8);
AT(ows_info_entry, identity_off, 152, 4);
AT(ows_info_entry, group_off, 156, 4);

AT(ows_name_entry, name_off, 0, 4);
AT(ows_name_entry, record, 4, 4);

AT(ows_target_entry, name, 0, 104);
AT(ows_target_entry, state, 104, 4);
AT(ows_target_entry, reconnects, 108, 4);
AT(ows_target_entry, group, 112, 4);
AT(ows_target_entry, moves, 116, 4);

AT(ows_counter_entry, name, 0, 48);
AT(ows_counter_entry, target, 48, 4);
AT(ows_counter_entry, low, 56, 4);
AT(ows_counter_entry, high, 60, 4);

AT(ows_who, serial, 0, 4);
AT(ows_who, uid, 4, 4);
AT(ows_who, pid, 8, 4);
AT(ows_who, name, 16, 32);
AT(ows_who, person, 48, 32);

AT(ows_origin_entry, seq, 0, 4);
AT(ows_origin_entry, reason, 4, 4);
AT(ows_origin_entry, taken_ns, 8, 8);
AT(ows_origin_entry, who, 16, 80);
AT(ows_origin_entry, check, 100, 4);

AT(ows_controller_entry, seq, 0, 4);
AT(ows_controller_entry, flags, 4, 4);
AT(ows_controller_entry, joined_ns, 8, 8);
AT(ows_controller_entry, who, 16, 80);
AT(ows_controller_entry, period_ms, 96, 4);
AT(ows_controller_entry, commands, 100, 4);
AT(ows_controller_entry, refused, 104, 4);
AT(ows_controller_entry, check, 116, 4);

AT(ows_shelf_entry, seq, 0, 4);
AT(ows_shelf_entry, record, 4, 4);
AT(ows_shelf_entry, since_ns, 8, 8);
AT(ows_shelf_entry, until_ns, 16, 8);
AT(ows_shelf_entry, who, 24, 80);
AT(ows_shelf_entry, why, 104, 64);
AT(ows_shelf_entry, check, 180, 4);

AT(ows_device_entry, seq, 0, 4);
AT(ows_device_entry, id_off, 4, 4);
AT(ows_device_entry, family_off, 8, 4);
AT(ows_device_entry, target, 12, 4);
AT(ows_device_entry, answers, 16, 8);
AT(ows_device_entry, errors, 24, 8);
AT(ows_device_entry, retries, 32, 8);
AT(ows_device_entry, wire_us, 40, 8);
AT(ows_device_entry, ok_ns, 48, 8);
AT(ows_device_entry, power, 56, 4);
AT(ows_device_entry, wire, 60, 4);
AT(ows_device_entry, identity, 64, 48);
AT(ows_device_entry, check, 124, 4);

AT(ows_log_entry, seq, 0, 4);
AT(ows_log_entry, number, 4, 4);
AT(ows_log_entry, time_ns, 8, 8);
AT(ows_log_entry, level, 16, 4);
AT(ows_log_entry, text, 20, 256);
AT(ows_log_entry, check, 276, 4);

AT(ows_journal_entry, seq, 0, 4);
AT(ows_journal_entry, record, 4, 4);
AT(ows_journal_entry, occurred_ns, 8, 8);
AT(ows_journal_entry, before, 16, 8);
AT(ows_journal_entry, after, 24, 8);
AT(ows_journal_entry, kind, 32, 1);
AT(ows_journal_entry, event, 33, 1);
AT(ows_journal_entry, quality, 34, 1);
AT(ows_journal_entry, flags, 35, 1);
AT(ows_journal_entry, more, 36, 4);
AT(ows_journal_entry, text, 40, 64);
AT(ows_journal_entry, who, 104, 80);
AT(ows_journal_entry, number, 184, 4);
AT(ows_journal_entry, check, 196, 4);

AT(ows_change_entry, number, 0, 4);
AT(ows_change_entry, record, 4, 4);

AT(ows_area_entry, kind, 0, 4);
AT(ows_area_entry, off, 4, 4);
AT(ows_area_entry, size, 8, 4);
AT(ows_area_entry, count, 12, 4);

AT(ows_image_header, magic, 0, 4);
AT(ows_image_header, major, 4, 2);
AT(ows_image_header, minor, 6, 2);
AT(ows_image_header, size, 8, 4);
AT(ows_image_header, generation, 12, 4);
AT(ows_image_header, state, 16, 4);
AT(ows_image_header, pid, 20, 4);
AT(ows_image_header, start_id, 24, 4);
AT(ows_image_header, area_off, 28, 4);
AT(ows_image_header, area_count, 32, 4);
AT(ows_image_header, served_off, 36, 4);
AT(ows_image_header, start_ns, 40, 8);
AT(ows_image_header, start_wall_ns, 48, 8);
AT(ows_image_header, period_ns, 56, 8);
AT(ows_image_header, news, 128, 4);
AT(ows_image_header, alarm_head, 132, 4);
AT(ows_image_header, command_head, 136, 4);
AT(ows_image_header, change_head, 140, 4);
AT(ows_image_header, awake, 192, 4);

AT(ows_command_slot, value, 0, 8);
AT(ows_command_slot, stamp, 8, 4);
AT(ows_command_slot, person, 12, 4);
AT(ows_command_slot, read_enable, 16, 4);
AT(ows_command_slot, write_enable, 20, 4);
AT(ows_command_slot, one_shot, 24, 4);
AT(ows_command_slot, dgn_reset, 28, 4);
AT(ows_command_slot, acknowledged, 32, 4);
AT(ows_command_slot, taken, 48, 4);
AT(ows_command_slot, applied, 52, 4);
AT(ows_command_slot, err, 56, 4);
AT(ows_command_slot, allowed, 60, 4);

AT(ows_command_text, len, 0, 4);
AT(ows_command_text, check, 4, 4);

AT(ows_command_shelf, count, 0, 4);
AT(ows_command_shelf, record, 4, 4);
AT(ows_command_shelf, seconds, 8, 4);
AT(ows_command_shelf, person, 12, 4);
AT(ows_command_shelf, why, 16, 64);
AT(ows_command_shelf, done, 80, 4);
AT(ows_command_shelf, err, 84, 4);

AT(ows_controller_header, magic, 0, 4);
AT(ows_controller_header, major, 4, 2);
AT(ows_controller_header, minor, 6, 2);
AT(ows_controller_header, size, 8, 4);
AT(ows_controller_header, generation, 12, 4);
AT(ows_controller_header, start_id, 16, 4);
AT(ows_controller_header, serial, 20, 4);
AT(ows_controller_header, slot_off, 24, 4);
AT(ows_controller_header, slot_size, 28, 4);
AT(ows_controller_header, slot_count, 32, 4);
AT(ows_controller_header, text_off, 36, 4);
AT(ows_controller_header, text_cap, 40, 4);
AT(ows_controller_header, place_off, 44, 4);
AT(ows_controller_header, dirty_off, 48, 4);
AT(ows_controller_header, dirty_words, 52, 4);
AT(ows_controller_header, person_off, 56, 4);
AT(ows_controller_header, shelf_off, 60, 4);
AT(ows_controller_header, state, 64, 4);
AT(ows_controller_header, marked, 128, 4);
AT(ows_controller_header, beat, 132, 4);
AT(ows_controller_header, period_ms, 136, 4);
AT(ows_controller_header, goodbye, 140, 4);
AT(ows_controller_header, waits, 144, 4);

AT(ows_hello, magic, 0, 4);
AT(ows_hello, major, 4, 2);
AT(ows_hello, minor, 6, 2);
AT(ows_hello, flags, 8, 4);
AT(ows_hello, token, 16, 16);
AT(ows_hello, name, 32, 32);

AT(ows_welcome, magic, 0, 4);
AT(ows_welcome, major, 4, 2);
AT(ows_welcome, minor, 6, 2);
AT(ows_welcome, err, 8, 4);
AT(ows_welcome, generation, 12, 4);
AT(ows_welcome, start_id, 16, 4);
AT(ows_welcome, serial, 20, 4);
AT(ows_welcome, size, 24, 4);
AT(ows_welcome, token, 32, 16);

_Static_assert(OWS_LAYOUT_MAJOR == 2, "these are the numbers of major version 2");
_Static_assert(OWS_JOURNAL == 256 && OWS_CONTROLLERS == 128 && OWS_SHELVES == 64, "published");
_Static_assert(OWS_PERSONS == 16 && OWS_NAME == 32, "published");
_Static_assert(OWS_TEXT == 64, "published");
_Static_assert(OWS_IMAGE_MAGIC == 0x4953574f && OWS_CONTROLLER_MAGIC == 0x4753574f &&
                       OWS_HELLO_MAGIC == 0x4853574f && OWS_WELCOME_MAGIC == 0x5753574f,
               "published");
_Static_assert(OWS_STATE_BUILDING == 0 && OWS_STATE_LIVE == 1 && OWS_STATE_RETIRED == 2 &&
                       OWS_STATE_STOPPED == 3,
               "published");
_Static_assert(OWS_AREA_RECORDS == 1 && OWS_AREA_INFOS == 2 && OWS_AREA_NAMES == 3 &&
                       OWS_AREA_TARGETS == 4 && OWS_AREA_COUNTERS == 5 && OWS_AREA_POOL == 6 &&
                       OWS_AREA_TEXTS == 7 && OWS_AREA_ORIGINS == 8 && OWS_AREA_CONTROLLERS == 9 &&
                       OWS_AREA_SHELVES == 10 && OWS_AREA_ALARMS == 11 && OWS_AREA_COMMANDS == 12 &&
                       OWS_AREA_CHANGES == 13 && OWS_AREA_DEVICES == 14 && OWS_AREA_LOG == 15 &&
                       OWS_AREA_REFUSED == 16 && OWS_AREA_NOTES == 17,
               "published");

static void test_check_words_are_as_published(void)
{
	static const uint32_t words[] = {1, 0xffffffffu, 0x4953574fu};

	TEST_ASSERT_EQUAL_HEX32(0x9e3779b9u, ows_check(words, 0));
	TEST_ASSERT_EQUAL_HEX32(0x111bc231u, ows_check(words, 3));
	TEST_ASSERT_EQUAL_HEX32(0x9e3779b9u, ows_check_bytes("", 0));
	TEST_ASSERT_EQUAL_HEX32(0x52210f29u, ows_check_bytes("boiler", 6));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_check_words_are_as_published);
	return UNITY_END();
}
