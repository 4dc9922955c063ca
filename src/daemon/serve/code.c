/* SPDX-License-Identifier: MIT */
/* The return codes of the served protocol, and their texts. */
#include <errno.h>
#include <string.h>

#include "src/daemon/serve/code.h"

int32_t code_of(int err)
{
	switch (-err) {
	case 0:
		return 0;
	case ENODEV:
	case ENOENT:
		return CODE_NO_SUCH_PATH;
	case EISDIR:
		return -21;
	case ENOTDIR:
		return -20;
	case EACCES:
	case EPERM:
	case EOPNOTSUPP:
		return -95;
	case EINVAL:
		return -22;
	case EOVERFLOW: /* a number overflows, or a list has no room */
		return -34;
	case EROFS:
		return CODE_READ_ONLY;
	case EMSGSIZE:
		return CODE_BAD_SIZE;
	default:
		return -5;
	}
}

static const struct {
	uint8_t code;
	const char *text;
} texts[] = {
	{0, "good"},
	{1, "no such device or property"},
	{5, "the device or the bus failed"},
	{14, "not a value of this property"},
	{16, "busy"},
	{19, "no such device"},
	{20, "not a directory"},
	{21, "is a directory"},
	{22, "not a value of this property"},
	{30, "writing is not allowed here"},
	{34, "out of range"},
	{42, "unknown request"},
	{73, "the write waited too long and was not done"},
	{74, "a request without a path"},
	{90, "a size that cannot be served"},
	{95, "the property cannot be read or written so"},
};

const char *code_text(unsigned code)
{
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++)
		if (texts[i].code == code)
			return texts[i].text;
	return "not used";
}

int code_texts(char *text, size_t room)
{
	size_t used = 0;

	for (unsigned code = 0; code < CODE_COUNT; code++) {
		const char *next = code_text(code);
		size_t len = strlen(next);

		if (len + 1 > room - used)
			return -EMSGSIZE;
		if (code)
			text[used++] = ',';
		/* its length ends it. NOLINTNEXTLINE(bugprone-not-null-terminated-result) */
		memcpy(text + used, next, len);
		used += len;
	}
	return (int)used;
}
