/* What channels mean: the table that the list of recording.h is written for. */
#include "recording/recording.h"

const struct dea_channel_meaning dea_channel_meanings[DEA_CHANNEL_KINDS] = {
#define DEA_CHANNEL_MEANING(enumerator, name, si, display, factor, meaning)                        \
  {name, si, display, factor, meaning},
    DEA_CHANNEL_LIST(DEA_CHANNEL_MEANING)
#undef DEA_CHANNEL_MEANING
};

const char *const dea_channel_names[DEA_CHANNEL_KINDS + 1] = {
#define DEA_CHANNEL_NAME(enumerator, name, si, display, factor, meaning) name,
    DEA_CHANNEL_LIST(DEA_CHANNEL_NAME)
#undef DEA_CHANNEL_NAME
        NULL};
