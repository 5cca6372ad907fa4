/* The channels of a surface file. */
#include <stdio.h>
#include <string.h>

#include "bench/cli/info.h"

void dif_info_channels_print(const dif_channels *channels, int chosen)
{
    for (int i = 0; i < channels->n; i++) {
        const dif_channel *channel = &channels->channel[i];
        char name[120];
        const bool has_alias = channel->alias[0] && strcmp(channel->alias, channel->name) != 0;
        snprintf(name, sizeof name, "%.40s%s%.40s%s%s%s", channel->name[0] ? channel->name : "(no name)",
                 has_alias ? " = " : "", has_alias ? channel->alias : "", channel->note[0] ? " (" : "", channel->note,
                 channel->note[0] ? ")" : "");
        printf("%s %c%2d  %5d x %-5d  %-8s %s\n", i ? "         " : "channels ", i + 1 == chosen ? '*' : ' ', i + 1,
               channel->nx, channel->ny, channel->unit[0] ? channel->unit : "-", name);
    }
    if (chosen)
        printf("           (* is read; --channel NAME or N reads another)\n");
}

json_t *dif_info_channels_json(const dif_channels *channels, int chosen)
{
    json_t *list = json_array();
    for (int i = 0; i < channels->n; i++) {
        const dif_channel *channel = &channels->channel[i];
        json_array_append_new(list, json_pack("{s:i, s:s, s:s, s:s, s:s, s:i, s:i, s:b, s:b}", "number", i + 1, "name",
                                              channel->name, "alias", channel->alias, "note", channel->note, "unit",
                                              channel->unit, "nx", channel->nx, "ny", channel->ny, "is_height",
                                              channel->is_height, "is_read", i + 1 == chosen));
    }
    return list;
}

void dif_info_unread(const dif_cli *cli, const dif_cli_input *input)
{
    if (input->channels.n < 2 || input->file.field.z_um)
        return;
    if (!cli->json) {
        printf("%s: %s\n", cli->operand[0], input->channels.format);
        dif_info_channels_print(&input->channels, 0);
        return;
    }
    json_t *object = json_pack("{s:s, s:s}", "kind", "channels", "format", input->channels.format);
    json_object_set_new(object, "channels", dif_info_channels_json(&input->channels, 0));
    (void)dif_json_print(cli, object);
}
