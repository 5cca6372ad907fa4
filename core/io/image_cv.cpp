#include "core/io/image_cv.h"

#include <climits>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/alloc.h"
#include "core/field.h"
#include "core/guard.hpp"

extern "C" {
#include "core/io/image_head.h"
}

namespace
{

// Samples a decoded picture may have: its doubles then take 2 GiB.
const long long PIXELS_MAX = 1LL << 28;

dif_status check_size(const dif_image_head &head, dif_error *err)
{
    if (head.nx < 1 || head.ny < 1)
        return dif_fail(err, DIF_ERR_FORMAT, "%lld x %lld pixels, want at least 1 x 1", head.nx, head.ny);
    if (head.nx > DIF_FIELD_SIDE_MAX || head.ny > DIF_FIELD_SIDE_MAX)
        return dif_fail(err, DIF_ERR_SIZE, "%lld x %lld pixels, want at most %d a side", head.nx, head.ny,
                        static_cast<int>(DIF_FIELD_SIDE_MAX));
    if (head.nx * head.ny > PIXELS_MAX)
        return dif_fail(err, DIF_ERR_SIZE, "%lld x %lld pixels, want at most %lld together", head.nx, head.ny,
                        PIXELS_MAX);
    return DIF_OK;
}

// Copies the first channel; false where another colour channel differs from it. Alpha (channel 3) is ignored.
template <class T> bool copy_grey(const cv::Mat &picture, uint16_t *value, int *x, int *y)
{
    const int n = picture.channels();
    for (int iy = 0; iy < picture.rows; iy++) {
        const T *row = picture.ptr<T>(iy);
        for (int ix = 0; ix < picture.cols; ix++) {
            const T *pixel = row + static_cast<size_t>(ix) * static_cast<size_t>(n);
            if (n >= 3 && (pixel[1] != pixel[0] || pixel[2] != pixel[0])) {
                *x = ix;
                *y = iy;
                return false;
            }
            *value++ = pixel[0];
        }
    }
    return true;
}

dif_status take_picture(const cv::Mat &picture, dif_image *out, dif_error *err)
{
    int x = 0, y = 0;
    const size_t n = static_cast<size_t>(picture.rows) * static_cast<size_t>(picture.cols);
    uint16_t *value = static_cast<uint16_t *>(dif_alloc(n, sizeof *value));
    if (!value)
        return dif_fail(err, DIF_ERR_NOMEM, "%d x %d pixels", picture.cols, picture.rows);
    const bool is_byte = picture.depth() == CV_8U;
    const bool grey =
        is_byte ? copy_grey<uint8_t>(picture, value, &x, &y) : copy_grey<uint16_t>(picture, value, &x, &y);
    if (!grey) {
        dif_release(value);
        return dif_fail(err, DIF_ERR_FORMAT, "a colour picture (first at column %d, row %d), want grey heights", x, y);
    }
    *out = dif_image{picture.cols, picture.rows, is_byte ? 8 : 16, value};
    return DIF_OK;
}

int colormap_number(const char *name)
{
    static const struct {
        const char *name;
        int number;
    } MAPS[] = {{"viridis", cv::COLORMAP_VIRIDIS}, {"inferno", cv::COLORMAP_INFERNO}, {"turbo", cv::COLORMAP_TURBO}};
    for (const auto &map : MAPS) {
        if (std::strcmp(map.name, name) == 0)
            return map.number;
    }
    return -1;
}

// Coordinates of OpenCV's drawing have this many binary places.
const int SHIFT = 4;

cv::Point fixed_point(double x, double y)
{
    return cv::Point(cvRound(std::ldexp(x, SHIFT)), cvRound(std::ldexp(y, SHIFT)));
}

const int FONT = cv::FONT_HERSHEY_SIMPLEX;
const double CAPITAL = 21.0; // height of its capitals at scale 1

// Walks over a text, degree signs apart (the font has none); draws it if there is a picture. Returns the width.
double put_text(cv::Mat *picture, const std::string &text, double x, double y, double scale, const cv::Scalar &colour,
                int stroke)
{
    static const char DEGREE[] = "\xC2\xB0";
    const double x_begin = x, radius = 0.16 * CAPITAL * scale;
    for (size_t at = 0; at < text.size();) {
        const size_t sign = text.find(DEGREE, at);
        const std::string piece = text.substr(at, sign == std::string::npos ? sign : sign - at);
        if (picture)
            cv::putText(*picture, piece, cv::Point(cvRound(x), cvRound(y)), FONT, scale, colour, stroke, cv::LINE_AA);
        int below = 0;
        x += cv::getTextSize(piece, FONT, scale, 1, &below).width;
        if (sign == std::string::npos)
            break;
        if (picture)
            cv::circle(*picture, fixed_point(x + radius, y - CAPITAL * scale + radius),
                       cvRound(std::ldexp(radius, SHIFT)), colour, stroke, cv::LINE_AA, SHIFT);
        x += 3.5 * radius;
        at = sign + sizeof DEGREE - 1;
    }
    return x - x_begin;
}

void draw_text(cv::Mat &picture, const dif_mark &mark, const cv::Scalar &colour, int stroke)
{
    double scale = mark.size / CAPITAL;
    const double width = put_text(nullptr, mark.text, 0.0, 0.0, scale, colour, stroke);
    const double shrink = mark.width_max > 0.0 && width > mark.width_max ? mark.width_max / width : 1.0;
    scale *= shrink;
    put_text(&picture, mark.text, mark.x - mark.anchor_x * width * shrink,
             mark.y + (1.0 - mark.anchor_y) * CAPITAL * scale, scale, colour, stroke);
}

void draw_stroke(cv::Mat &picture, const dif_mark &mark, const cv::Scalar &colour, int stroke)
{
    if (mark.kind == DIF_MARK_TEXT)
        draw_text(picture, mark, colour, stroke);
    else if (mark.kind == DIF_MARK_LINE)
        cv::line(picture, fixed_point(mark.x, mark.y), fixed_point(mark.x1, mark.y1), colour, stroke, cv::LINE_AA,
                 SHIFT);
    else
        cv::circle(picture, fixed_point(mark.x, mark.y), cvRound(std::ldexp(mark.size, SHIFT)), colour, stroke,
                   cv::LINE_AA, SHIFT);
}

bool is_drawable(const dif_mark &mark)
{
    const double far = 1e5; // coordinates stay far inside an int
    const bool placed = std::fabs(mark.x) < far && std::fabs(mark.y) < far;
    if (!placed || mark.stroke < 1 || mark.stroke > 100)
        return false;
    if (mark.kind == DIF_MARK_LINE)
        return std::fabs(mark.x1) < far && std::fabs(mark.y1) < far;
    return mark.size > 0.0 && mark.size < far && (mark.kind != DIF_MARK_TEXT || mark.text);
}

dif_status encode(const cv::Mat &picture, unsigned char **png, size_t *n, dif_error *err)
{
    std::vector<uchar> bytes;
    if (!cv::imencode(".png", picture, bytes))
        return dif_fail(err, DIF_ERR_FOREIGN, "PNG of %d x %d pixels was not encoded", picture.cols, picture.rows);
    unsigned char *copy = static_cast<unsigned char *>(dif_alloc(bytes.size(), 1));
    if (!copy)
        return dif_fail(err, DIF_ERR_NOMEM, "PNG of %zu bytes", bytes.size());
    std::memcpy(copy, bytes.data(), bytes.size());
    *png = copy;
    *n = bytes.size();
    return DIF_OK;
}

} // namespace

dif_status dif_image_draw(uint8_t *rgb, int nx, int ny, int n, const dif_mark *mark, dif_error *err)
{
    return dif_guard(err, [&] {
        if (!rgb || nx < 1 || ny < 1)
            return dif_fail(err, DIF_ERR_ARG, "picture of %d x %d pixels", nx, ny);
        cv::Mat picture(ny, nx, CV_8UC3, rgb);
        for (int i = 0; i < n; i++) {
            const dif_mark &m = mark[i];
            if (!is_drawable(m))
                return dif_fail(err, DIF_ERR_ARG, "mark %d of a picture is not drawable", i);
            if (m.halo)
                draw_stroke(picture, m, cv::Scalar(0, 0, 0), m.stroke + 2);
            draw_stroke(picture, m, cv::Scalar(m.rgb[0], m.rgb[1], m.rgb[2]), m.stroke);
        }
        return DIF_OK;
    });
}

dif_status dif_image_decode(const unsigned char *data, size_t n, dif_image *out, dif_error *err)
{
    *out = dif_image{};
    return dif_guard(err, [&] {
        dif_image_head head;
        dif_status status = dif_image_head_read(data, n, &head, err);
        if (!status)
            status = check_size(head, err);
        if (status)
            return status;
        if (n > INT_MAX)
            return dif_fail(err, DIF_ERR_SIZE, "image file of %zu bytes", n);
        // As it is: depth and alpha kept, no turning by a camera's orientation.
        const cv::Mat bytes(1, static_cast<int>(n), CV_8U, const_cast<unsigned char *>(data));
        const cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
        if (picture.empty() || picture.cols != head.nx || picture.rows != head.ny)
            return dif_fail(err, DIF_ERR_FORMAT, "%s cannot be decoded (damaged?)", head.format);
        if (picture.depth() != CV_8U && picture.depth() != CV_16U)
            return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s has neither 8 nor 16 bits a sample", head.format);
        return take_picture(picture, out, err);
    });
}

dif_status dif_image_decode_rgb(const unsigned char *data, size_t n, uint8_t **rgb, int *nx, int *ny, dif_error *err)
{
    *rgb = nullptr;
    *nx = *ny = 0;
    return dif_guard(err, [&] {
        dif_image_head head;
        dif_status status = dif_image_head_read(data, n, &head, err);
        if (!status)
            status = check_size(head, err);
        if (status)
            return status;
        if (n > INT_MAX)
            return dif_fail(err, DIF_ERR_SIZE, "image file of %zu bytes", n);
        const cv::Mat bytes(1, static_cast<int>(n), CV_8U, const_cast<unsigned char *>(data));
        cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
        if (picture.empty() || picture.cols != head.nx || picture.rows != head.ny || picture.type() != CV_8UC3)
            return dif_fail(err, DIF_ERR_FORMAT, "%s cannot be decoded (damaged?)", head.format);
        *rgb =
            static_cast<uint8_t *>(dif_alloc(static_cast<size_t>(picture.rows) * 3, static_cast<size_t>(picture.cols)));
        if (!*rgb)
            return dif_fail(err, DIF_ERR_NOMEM, "%d x %d pixels", picture.cols, picture.rows);
        cv::Mat target(picture.rows, picture.cols, CV_8UC3, *rgb);
        cv::cvtColor(picture, target, cv::COLOR_BGR2RGB);
        *nx = picture.cols;
        *ny = picture.rows;
        return DIF_OK;
    });
}

dif_status dif_image_colormap(const char *name, uint8_t rgb[256][3], dif_error *err)
{
    return dif_guard(err, [&] {
        cv::Mat grey(1, 256, CV_8U), bgr;
        for (int i = 0; i < 256; i++)
            grey.at<uint8_t>(0, i) = static_cast<uint8_t>(i);
        if (std::strcmp(name, "gray") == 0)
            cv::cvtColor(grey, bgr, cv::COLOR_GRAY2BGR);
        else if (colormap_number(name) >= 0)
            cv::applyColorMap(grey, bgr, colormap_number(name));
        else
            return dif_fail(err, DIF_ERR_ARG, "colour map '%.30s', want viridis, inferno, turbo or gray", name);
        for (int i = 0; i < 256; i++) {
            const cv::Vec3b colour = bgr.at<cv::Vec3b>(0, i);
            for (int k = 0; k < 3; k++)
                rgb[i][k] = colour[2 - k];
        }
        return DIF_OK;
    });
}

dif_status dif_image_encode_png(const uint8_t *rgb, int nx, int ny, unsigned char **png, size_t *n, dif_error *err)
{
    *png = nullptr;
    *n = 0;
    return dif_guard(err, [&] {
        if (!rgb || nx < 1 || ny < 1)
            return dif_fail(err, DIF_ERR_ARG, "picture of %d x %d pixels", nx, ny);
        const cv::Mat picture(ny, nx, CV_8UC3, const_cast<uint8_t *>(rgb));
        cv::Mat bgr;
        cv::cvtColor(picture, bgr, cv::COLOR_RGB2BGR);
        return encode(bgr, png, n, err);
    });
}

dif_status dif_image_encode_grey(const uint16_t *value, int nx, int ny, unsigned char **png, size_t *n, dif_error *err)
{
    *png = nullptr;
    *n = 0;
    return dif_guard(err, [&] {
        if (!value || nx < 1 || ny < 1)
            return dif_fail(err, DIF_ERR_ARG, "picture of %d x %d pixels", nx, ny);
        return encode(cv::Mat(ny, nx, CV_16U, const_cast<uint16_t *>(value)), png, n, err);
    });
}

dif_status dif_image_resize(const float *src, int nx, int ny, float *dst, int mx, int my, dif_error *err)
{
    return dif_guard(err, [&] {
        if (!src || !dst || nx < 1 || ny < 1 || mx < 1 || my < 1)
            return dif_fail(err, DIF_ERR_ARG, "resampling of %d x %d to %d x %d", nx, ny, mx, my);
        const cv::Mat from(ny, nx, CV_32F, const_cast<float *>(src));
        cv::Mat to(my, mx, CV_32F, dst);
        cv::resize(from, to, to.size(), 0.0, 0.0, mx <= nx && my <= ny ? cv::INTER_AREA : cv::INTER_LINEAR);
        return DIF_OK;
    });
}
