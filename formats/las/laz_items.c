#include "las/laz_items.h"

static void expect(laz_items *items, laz_item_type type, size_t size)
{
	items->item[items->count++] = (laz_item){ type, size, 0, items->record };
	items->record += size;
}

laz_items laz_items_make(unsigned format, size_t record)
{
	laz_items items = { .layered = format >= 6 };
	expect(&items, items.layered ? LAZ_POINT14 : LAZ_POINT10, items.layered ? 30 : 20);
	if (format == 1 || format == 3 || format == 4 || format == 5)
		expect(&items, LAZ_GPSTIME11, 8);
	if (format == 2 || format == 3 || format == 5)
		expect(&items, LAZ_RGB12, 6);
	if (format == 7)
		expect(&items, LAZ_RGB14, 6);
	if (format == 8 || format == 10)
		expect(&items, LAZ_RGBNIR14, 8);
	if (format == 4 || format == 5)
		expect(&items, LAZ_WAVEPACKET13, 29);
	if (format == 9 || format == 10)
		expect(&items, LAZ_WAVEPACKET14, 29);
	if (record > items.record)
		expect(&items, items.layered ? LAZ_BYTE14 : LAZ_BYTE, record - items.record);
	return items;
}
