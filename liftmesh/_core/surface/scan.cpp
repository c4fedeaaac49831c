#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "surface/bands.hpp"
#include "surface/sample.hpp"
#include "surface/span.hpp"

namespace liftmesh {

namespace {

// Rows of faces that may be met for each pixel and each face, before its location costs less.
constexpr std::size_t most_rows = 4;
constexpr std::int32_t ahead = 8;  // faces, whose corners are fetched meanwhile
constexpr std::size_t located_together = std::size_t{1} << 20;

// Some rows of a face.
struct FaceRows {
    std::int32_t first, count;
    const RowSpans& spans;

    // Calls visit(row, columns) with those that surely are in the face.
    template <class Visit>
    void for_each(Visit visit) const {
        for (std::int32_t i = 0; i < count; ++i)
            if (const Interval columns = spans.sure(i); !columns.is_empty())
                visit(first + i, columns);
    }
};

// Writes heights.
template <class Real>
struct Heighten {
    const Relief& relief;
    const Grid& grid;
    Real* heights;

    static constexpr bool needs_owner = false;  // all faces at a vertex give the same height
    static constexpr std::size_t width = 1;
    static constexpr Real nothing = static_cast<Real>(no_height);
    Real* out() const { return heights; }

    void fill(std::int32_t, const SurfaceFacet& facet, const FaceRows& rows) const {
        if (!facet.is_plain()) {
            rows.for_each([&](std::int32_t row, Interval columns) {
                for (std::int32_t at = columns.first; at <= columns.last; ++at)
                    heights[grid.pixel(row, at)] =
                        static_cast<Real>(facet.height(grid.centre(row, at)));
            });
        } else if (grid.d == 0) {
            fill_plainly<true>(facet, rows);
        } else {
            fill_plainly<false>(facet, rows);
        }
    }
    // Two at a time; of an odd number the last two overlap those before. Works on copies, which no
    // height that is written can change. Where rows are level, their pixels have one y.
    template <bool is_level>
    void fill_plainly(SurfaceFacet facet, const FaceRows& rows) const {
        const Grid pixels = grid;
        rows.for_each([&, start = heights](std::int32_t row, Interval columns) {
            Real* to = start + pixels.pixel(row, 0);
            const auto [first, last] = columns;
            if (first == last) {
                to[last] = static_cast<Real>(facet.plain_height(pixels.centre(row, last)));
                return;
            }
            const Pair level = pixels.centres(row, first).y;
            const auto put_two = [&](std::int32_t at) {
                const auto [x, y] = pixels.centres(row, at);
                store(facet.plain_heights(x, is_level ? level : y), to + at);
            };
            put_two(last - 1);
            for (std::int32_t at = first; at < last - 1; at += 2) put_two(at);
        });
    }
    void put(std::int32_t face, Relief::Place place, Point centre, std::size_t pixel) const {
        heights[pixel] = static_cast<Real>(relief.height(centre, face, place));
    }
};

struct Incline {
    const Relief& relief;
    const Grid& grid;
    double* gradients;

    static constexpr bool needs_owner = true;
    static constexpr std::size_t width = 2;
    static constexpr double nothing = no_height;
    double* out() const { return gradients; }

    void fill(std::int32_t, const SurfaceFacet& facet, const FaceRows& rows) const {
        const Point slopes = facet.gradient();
        rows.for_each([&](std::int32_t row, Interval columns) {
            for (std::int32_t at = columns.first; at <= columns.last; ++at)
                write(slopes, grid.pixel(row, at));
        });
    }
    void put(std::int32_t face, Relief::Place, Point, std::size_t pixel) const {
        write(relief.facet(face).gradient(), pixel);
    }
    void write(Point slopes, std::size_t pixel) const {
        gradients[2 * pixel] = slopes.x;
        gradients[2 * pixel + 1] = slopes.y;
    }
};

struct Name {
    const Grid& grid;
    std::int32_t* owners;

    static constexpr bool needs_owner = true;
    static constexpr std::size_t width = 1;
    static constexpr std::int32_t nothing = outside;
    std::int32_t* out() const { return owners; }

    void fill(std::int32_t face, const SurfaceFacet&, const FaceRows& rows) const {
        rows.for_each([&](std::int32_t row, Interval columns) {
            std::int32_t* to = owners + grid.pixel(row, 0);
            std::fill(to + columns.first, to + columns.last + 1, face);
        });
    }
    void put(std::int32_t face, Relief::Place, Point, std::size_t pixel) const {
        owners[pixel] = face;
    }
};

template <class Sink>
class Scan {
 public:
    Scan(const Relief& relief, const PixelFinder& finder, const Sink& sink, ThreadPool& pool)
        : relief_(relief), finder_(finder), grid_(finder.grid()), sink_(sink), pool_(pool) {}

    // On one thread bands would only cost their lists. False if it is more work than `most` rows.
    static bool run_alone(const Relief& relief, const PixelFinder& finder, const Sink& sink,
                          ThreadPool& pool, std::size_t most) {
        Patience patience(pool.interrupt());
        Scan scan(relief, finder, sink, pool);
        scan.clear(0, finder.grid().rows - 1);
        const auto count = static_cast<std::int32_t>(relief.mesh().count);
        for (std::int32_t face = 0; face < count && !patience.ends(); ++face) {
            if (face + ahead < count) relief.prefetch(face + ahead);
            if (!relief.is_shown(face)) continue;
            const std::size_t rows = scan.scan_face(face, 0, finder.grid().rows - 1, patience);
            if (rows > most) return false;
            most -= rows;
        }
        return true;
    }

    bool run(const Bands& bands) {
        bands_ = &bands;
        return pool_.run(bands.size(), [this](std::size_t band) { scan_band(band); }) &&
               !pool_.interrupt().requested();
    }

 private:
    void clear(std::int32_t first, std::int32_t last) {
        const std::size_t begin = grid_.pixel(first, 0), end = grid_.pixel(last + 1, 0);
        std::fill(sink_.out() + Sink::width * begin, sink_.out() + Sink::width * end,
                  Sink::nothing);
    }

    void scan_band(std::size_t band) {
        Patience patience(pool_.interrupt());
        const std::int32_t first = bands_->first_row(band);
        const std::int32_t last = std::min(bands_->first_row(band + 1), grid_.rows) - 1;
        clear(first, last);
        const std::int32_t* faces = bands_->begin(band);
        const auto count = static_cast<std::size_t>(bands_->end(band) - faces);
        for (std::size_t i = 0; i < count && !patience.ends(); ++i) {
            if (i + ahead < count && faces[i + ahead] >= 0) relief_.prefetch(faces[i + ahead]);
            if (faces[i] >= 0) scan_face(faces[i], first, last, patience);
        }
    }

    // Returns how many rows the face has.
    std::size_t scan_face(std::int32_t face, std::int32_t first, std::int32_t last,
                          Patience& patience) {
        const Triangulated& mesh = relief_.mesh();
        const Point corners[3] = {mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2)};
        const double far = finder_.far(corners);
        const PixelBox box = finder_.box(corners, far);
        if (box.is_empty()) return 0;
        const Spans spans(grid_, corners, box, far);
        const SurfaceFacet facet = relief_.facet(face);
        first = std::max(first, box.rows.first);
        last = std::min(last, box.rows.last);
        const std::int32_t most = rows_together(box.columns);
        const auto across = static_cast<std::size_t>(box.columns.last - box.columns.first);
        RowSpans found;
        while (first <= last && !patience.ends()) {
            const FaceRows rows{first, std::min(most, last - first + 1), found};
            spans.put(first, rows.count, found);
            sink_.fill(face, facet, rows);
            patience.ends(static_cast<std::size_t>(rows.count) * across / 8);
            if (!found.are_sure) judge_borders(face, rows, patience);
            first += rows.count;
        }
        return static_cast<std::size_t>(box.rows.last - box.rows.first + 1);
    }

    // The spans of many rows are computed at once, unless rows are so long that they take longer.
    static std::int32_t rows_together(Interval columns) {
        return columns.last - columns.first < 1024 ? RowSpans::most : 2;
    }

    void judge_borders(std::int32_t face, const FaceRows& rows, Patience& patience) {
        for (std::int32_t i = 0; i < rows.count; ++i) {
            const auto possible = rows.spans.possible(i), sure = rows.spans.sure(i);
            if (rows.spans.is_sure(i)) continue;
            const bool any = !sure.is_empty();
            judge(face, rows.first + i, {possible.first, any ? sure.first - 1 : possible.last},
                  patience);
            if (any) judge(face, rows.first + i, {sure.last + 1, possible.last}, patience);
        }
    }

    // Pixels near the border of a face.
    void judge(std::int32_t face, std::int32_t row, Interval columns, Patience& patience) {
        for (std::int32_t at = columns.first; at <= columns.last; ++at) {
            const Point centre = grid_.centre(row, at);
            const Relief::Place place = relief_.place(centre, face);
            if (place.kind == Relief::Place::beyond || !owns(face, place, patience)) continue;
            sink_.put(face, place, centre, grid_.pixel(row, at));
        }
    }

    bool owns(std::int32_t face, Relief::Place place, Patience& patience) {
        if (place.kind == Relief::Place::side) return relief_.owns_side(face, place.k);
        if (place.kind == Relief::Place::inside || !Sink::needs_owner) return true;
        const std::int32_t row = relief_.mesh().vertex(face, place.k);
        return relief_.owner_of_vertex(row, face, patience) == face;
    }

    const Relief& relief_;
    const PixelFinder& finder_;
    const Grid& grid_;
    const Sink& sink_;
    const Bands* bands_ = nullptr;
    ThreadPool& pool_;
};

// Calls locate(queries, first pixel) for the centres, many at a time.
template <class Locate>
bool at_centres(const Grid& grid, Locate locate) {
    const std::size_t pixels = grid.pixels();
    const auto columns = static_cast<std::size_t>(grid.columns);
    const auto centres = allocate<double>(2 * std::min(pixels, located_together));
    for (std::size_t start = 0; start < pixels; start += located_together) {
        const std::size_t count = std::min(located_together, pixels - start);
        for (std::size_t i = 0; i < count; ++i) {
            const Point at = grid.centre(static_cast<std::int32_t>((start + i) / columns),
                                         static_cast<std::int32_t>((start + i) % columns));
            centres[2 * i] = at.x;
            centres[2 * i + 1] = at.y;
        }
        if (!locate(Queries{centres.get(), count}, start)) return false;
    }
    return true;
}

// Scans, or locates the centres where that is less work.
template <class Sink, class Locate>
bool scan(const Relief& relief, const Grid& grid, const Sink& sink, Threads threads,
          Interrupt& interrupt, Locate locate) {
    const IeeeArithmetic ieee;
    {
        ThreadPool pool(threads.for_rows(grid.pixels() + relief.mesh().count), interrupt);
        const PixelFinder finder(grid);
        const std::size_t most = most_rows * (grid.pixels() + relief.mesh().count);
        if (pool.size() == 1) {
            if (Scan<Sink>::run_alone(relief, finder, sink, pool, most))
                return !interrupt.requested();
        } else {
            Bands bands(relief, finder, pool);
            if (!bands.count()) return false;
            if (bands.face_rows() <= most)
                return bands.list() && Scan<Sink>(relief, finder, sink, pool).run(bands);
        }
        if (interrupt.requested()) return false;
    }
    return at_centres(grid, locate);
}

template <class Real>
bool scan_real(const Relief& relief, Locator& locator, const Grid& grid, Real* heights,
               Threads threads, Interrupt& interrupt) {
    const auto locate = [&](const Queries& queries, std::size_t start) {
        if constexpr (std::is_same_v<Real, double>) {
            return sample_heights(relief, locator, queries, heights + start, threads, interrupt);
        } else {
            const auto found = allocate<double>(queries.count);
            const bool done =
                sample_heights(relief, locator, queries, found.get(), threads, interrupt);
            for (std::size_t i = 0; done && i < queries.count; ++i)
                heights[start + i] = static_cast<Real>(found[i]);
            return done;
        }
    };
    return scan(relief, grid, Heighten<Real>{relief, grid, heights}, threads, interrupt, locate);
}

}  // namespace

bool scan_heights(const Relief& relief, Locator& locator, const Grid& grid, double* heights,
                  Threads threads, Interrupt& interrupt) {
    return scan_real(relief, locator, grid, heights, threads, interrupt);
}

bool scan_heights(const Relief& relief, Locator& locator, const Grid& grid, float* heights,
                  Threads threads, Interrupt& interrupt) {
    return scan_real(relief, locator, grid, heights, threads, interrupt);
}

bool scan_gradients(const Relief& relief, Locator& locator, const Grid& grid, double* gradients,
                    Threads threads, Interrupt& interrupt) {
    return scan(relief, grid, Incline{relief, grid, gradients}, threads, interrupt,
                [&](const Queries& queries, std::size_t start) {
                    return sample_gradients(relief, locator, queries, gradients + 2 * start,
                                            threads, interrupt);
                });
}

bool scan_owners(const Relief& relief, Locator& locator, const Grid& grid, std::int32_t* owners,
                 Threads threads, Interrupt& interrupt) {
    return scan(relief, grid, Name{grid, owners}, threads, interrupt,
                [&](const Queries& queries, std::size_t start) {
                    return sample_owners(relief, locator, queries, owners + start, threads,
                                         interrupt);
                });
}

}  // namespace liftmesh
