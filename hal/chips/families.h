/* SPDX-License-Identifier: MIT */
/*
 * The chip families of this build, in the order of their codes: the one list of them. A new family
 * is one line here and one file. Included where FAMILY(code) says what is made of each.
 */
FAMILY(01) /* DS2401 */
FAMILY(02) /* DS1991 */
FAMILY(04) /* DS2404 */
FAMILY(05) /* DS2405 */
FAMILY(06) /* DS1993 */
FAMILY(08) /* DS1992 */
FAMILY(09) /* DS2502 */
FAMILY(0a) /* DS1995 */
FAMILY(0b) /* DS2505 */
FAMILY(0c) /* DS1996 */
FAMILY(0f) /* DS2506 */
FAMILY(10) /* DS18S20 */
FAMILY(12) /* DS2406 */
FAMILY(14) /* DS2430A */
FAMILY(18) /* DS1963S */
FAMILY(1a) /* DS1963L */
FAMILY(1b) /* DS2436 */
FAMILY(1c) /* DS28E04 */
FAMILY(1d) /* DS2423 */
FAMILY(1e) /* DS2437 */
FAMILY(1f) /* DS2409 */
FAMILY(20) /* DS2450 */
FAMILY(21) /* DS1921 */
FAMILY(22) /* DS1822 */
FAMILY(23) /* DS2433 */
FAMILY(24) /* DS2415 */
FAMILY(26) /* DS2438 */
FAMILY(27) /* DS2417 */
FAMILY(28) /* DS18B20 */
FAMILY(29) /* DS2408 */
FAMILY(2c) /* DS2890 */
FAMILY(2d) /* DS2431 */
FAMILY(2e) /* DS2770 */
FAMILY(30) /* DS2760 */
FAMILY(31) /* DS2720 */
FAMILY(32) /* DS2780 */
FAMILY(35) /* DS2755 */
FAMILY(36) /* DS2740 */
FAMILY(37) /* DS1977 */
FAMILY(3a) /* DS2413 */
FAMILY(3b) /* DS1825 */
FAMILY(3d) /* DS2781 */
FAMILY(41) /* DS1923 */
FAMILY(42) /* DS28EA00 */
FAMILY(43) /* DS28EC20 */
FAMILY(51) /* DS2751 */
FAMILY(54) /* MAX31888 */
FAMILY(7e) /* EDS0064 to EDS0090 */
FAMILY(81) /* DS1420 */
FAMILY(82) /* DS1425 */
FAMILY(89) /* DS1982U */
FAMILY(8b) /* DS1985U */
FAMILY(8f) /* DS1986U */
FAMILY(a0) /* mRS001 */
FAMILY(a2) /* mCM001 */
FAMILY(a5) /* mDI001 */
FAMILY(a6) /* DS2438 */
FAMILY(b2) /* mAM001 */
FAMILY(ed) /* Inferno Embedded */
FAMILY(ee) /* Hobby Boards: UVI meter */
FAMILY(ef) /* Hobby Boards: moisture meter, hub, barometer, ... */
FAMILY(fc) /* BAE */
FAMILY(fe) /* IBLSS */
FAMILY(ff) /* LCD by Louis Swart */
