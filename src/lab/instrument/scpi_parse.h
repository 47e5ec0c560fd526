/* Commands and responses of SCPI instruments (SCPI 1999, IEEE 488.2). */
#ifndef DEA_LAB_INSTRUMENT_SCPI_PARSE_H
#define DEA_LAB_INSTRUMENT_SCPI_PARSE_H

#include <stdbool.h>

enum { DEA_SCPI_SUFFIX_SIZE = 24 };

/* The first number of a response such as "+1.04E-11", "1.2E-9A,+3.1E+2secs" or " 5". NAN for the
 * numbers that SCPI has for infinity, its negative and no number: 9.9E37, -9.9E37 and 9.91E37
 * (larger ones too). false when it does not begin with a number, or when nobody can tell
 * whether "0,123" is one number with a decimal comma or two. */
bool dea_scpi_number(const char *response, double *value);
/* The number of a response that is a voltage: alone, the first of several, or with a unit behind it
 * that it may have (V, VDC; kV, kVDC). false where anything else stands there, as that could change
 * it by a thousand, and for the numbers that mean none. */
bool dea_scpi_voltage(const char *response, bool in_V, bool in_kV, double *value);
/* What stands behind that number up to the next comma, without blanks: a unit, "mN", or a state,
 * "NADC"; cut off when it is long. "" when it does not begin with a number. */
void dea_scpi_suffix(const char *response, char out[DEA_SCPI_SUFFIX_SIZE]);
/* An entry of the error queue: -113,"Undefined header". The code, 0 for none; *text: from the comma
 * on, lent. false when it is none. */
bool dea_scpi_error(const char *response, int *code, const char **text);
/* Whether a number can be put in place of the one %g of a command, and nothing around it changes
 * what the number means: no digit, sign or unit beside it, no second command. */
bool dea_scpi_output_is_plain(const char *output);
/* Whether a command gives something other than 0, a number or a word (MAX), to what `output` (a
 * plain one) sets: the same text before the number, or the same last mnemonic by its short form of
 * four letters, without [:LEVel][:IMMediate][:AMPLitude]; where words stand between that and the
 * number
 * ("BSWV OFST,%g"), with a number anywhere. So do APPLy with a number, and *RCL. */
bool dea_scpi_sets_output(const char *command, const char *output);
/* Whether a command is about what is measured (CONFigure, SENSe), not about a source. */
bool dea_scpi_configures(const char *command);
/* Whether it has no line's end in it, behind which another command would begin, nor any other
 * control character. */
bool dea_scpi_is_one_line(const char *command);

#endif
