/*
 * panorama_dwa.cpp - pixels compressed by DWA, which OpenEXRCore names but does not decode: by the
 * C++ library of OpenEXR, which has no C interface to a stream of its own.
 */
extern "C" {
#include "files/little_endian.h"
#include "panoramas/panorama.h"
}

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>

#include <cstring>
#include <new>
#include <stdexcept>

namespace
{

/* The bytes of an input as the library's stream; reading past the end throws, as it wants. */
class bytes_stream : public Imf::IStream
{
  public:
	explicit bytes_stream(const input_file *in) : Imf::IStream(in->name), in_(in)
	{
	}

	bool read(char bytes[], int count) override
	{
		if (count < 0 || static_cast<uint64_t>(count) > in_->length - at_)
			throw std::runtime_error("it ends before its pixels do");
		std::memcpy(bytes, in_->data + at_, static_cast<size_t>(count));
		at_ += static_cast<uint64_t>(count);
		return at_ < in_->length;
	}

	uint64_t tellg() override
	{
		return at_;
	}

	void seekg(uint64_t at) override
	{
		at_ = at < in_->length ? at : in_->length;
	}

  private:
	const input_file *in_;
	uint64_t at_ = 0;
};

/* The library allocates what an attribute of the header claims before it reads it; so each has to
 * fit: name and type, both ended by a zero, the size of the value, the value. An empty name ends.
 */
bool attributes_fit(const input_file *in)
{
	size_t at = 8; /* behind magic number and version */
	while (at < in->length && in->data[at] != 0) {
		for (int text = 0; text < 2; text++) {
			const void *zero = std::memchr(in->data + at, 0, in->length - at);
			if (!zero)
				return false;
			at = static_cast<size_t>(static_cast<const uint8_t *>(zero) - in->data) + 1;
		}
		if (in->length - at < 4)
			return false;
		const uint32_t size = load_32(in->data + at);
		at += 4;
		if (size > in->length - at)
			return false;
		at += size;
	}
	return at < in->length;
}

/* A channel that goes to one of the map's three floats a pixel. */
Imf::Slice slice_of(const panorama *map, const Imath::Box2i &window, int channel)
{
	const std::ptrdiff_t pixel = 3 * sizeof(float), row = pixel * map->width;
	char *first = reinterpret_cast<char *>(map->pixels + channel);
	return Imf::Slice(Imf::FLOAT, first - window.min.x * pixel - window.min.y * row,
					  static_cast<size_t>(pixel), static_cast<size_t>(row));
}

} // namespace

extern "C" gw_status panorama_dwa_pixels(const input_file *in, bool rgb, panorama *map,
										 gw_error *error)
{
	if (!attributes_fit(in))
		return gw_fail(error, GW_ERROR_DATA, "%s cannot be read as EXR: its header is damaged",
					   in->name);
	try {
		static const char *const colours[] = { "R", "G", "B" };
		bytes_stream stream(in);
		Imf::InputFile file(stream);
		const Imath::Box2i window = file.header().dataWindow();
		Imf::FrameBuffer frame;
		for (int c = 0; c < (rgb ? 3 : 1); c++)
			frame.insert(rgb ? colours[c] : "Y", slice_of(map, window, c));
		file.setFrameBuffer(frame);
		file.readPixels(window.min.y, window.max.y);
		return GW_OK;
	} catch (const std::bad_alloc &) {
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to read %s", in->name);
	} catch (const std::exception &problem) {
		return gw_fail(error, GW_ERROR_DATA, "%s cannot be read as EXR: %s", in->name,
					   problem.what());
	}
}
