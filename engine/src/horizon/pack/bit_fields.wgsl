// The skyline from fields of bits, their values summed over up to four resolutions. Twin of `water.rs`.

override HORIZON_WORDS: u32 = 4u;
// Bits of a texel's gain, the lowest of its first word.
override HORIZON_GAIN_BITS: u32 = 2u;
// By how much elevations exceed what the series says of them, over its cube: 0 where they do not.
override HORIZON_GROWTH: f32 = 2.5;

// The words of a texel; those beyond HORIZON_WORDS belong to others.
struct HorizonWords {
    low: vec4u,
    high: vec4u,
}

fn horizon_words(offset: u32, texel: u32) -> HorizonWords {
    let first = texel * HORIZON_WORDS;
    let low = horizon_texel(offset + first / 4u);
    if HORIZON_WORDS == 4u {
        return HorizonWords(low, low);
    }
    if HORIZON_WORDS == 2u {
        let words = select(low, low.zwxy, first % 4u == 2u);
        return HorizonWords(words, words);
    }
    let high = horizon_texel(offset + (first + HORIZON_WORDS - 1u) / 4u);
    switch first % 4u {
        case 1u: { return HorizonWords(low.yzwx, high); }
        case 2u: { return HorizonWords(vec4u(low.zw, high.xy), high); }
        case 3u: { return HorizonWords(vec4u(low.w, high.xyz), high); }
        default: { return HorizonWords(low, high); }
    }
}

fn horizon_gain(words: HorizonWords) -> f32 {
    return f32(1u << (words.low.x & ((1u << HORIZON_GAIN_BITS) - 1u)));
}

// A signed field: `description` holds from bit 0 its word, and from bits 8 and 16 how far it is shifted left and right.
fn horizon_code(words: HorizonWords, description: u32) -> f32 {
    let left = (description >> 8u) & 31u;
    let right = (description >> 16u) & 31u;
    var word = words.low[description & 3u];
    if HORIZON_WORDS > 4u && (description & 4u) != 0u {
        word = words.high[description & 3u];
    }
    return f32(i32(word << left) >> right);
}

// Adds the fields of one page; `fields` are those of `first` to before `end` in the map's table. A field's entry is its
// description, which holds from bit 24 twice its order, plus one for a sine, then its step, its offset and its bias.
fn horizon_page(horizon: HorizonGrid, page: u32, offset: u32, fields: vec2u, grid: vec2f, step: vec2f) -> vec2f {
    let cell = horizon_cell(horizon, page, grid);
    let south_west = horizon_words(offset, cell.texels.x);
    let south_east = horizon_words(offset, cell.texels.y);
    let north_west = horizon_words(offset, cell.texels.z);
    let north_east = horizon_words(offset, cell.texels.w);
    let gains = vec4f(horizon_gain(south_west), horizon_gain(south_east), horizon_gain(north_west), horizon_gain(north_east));
    var turned = vec2f(1.0, 0.0);
    var order = 0u;
    var sum = vec2f(0.0);
    for (var i = fields.x; i < fields.y; i++) {
        let field = horizon_texel(horizon.table + i);
        let real = field.x >> 24u;
        for (; order < real / 2u; order++) {
            turned = horizon_turn(turned, step);
        }
        let south = vec2f(horizon_code(south_west, field.x), horizon_code(south_east, field.x));
        let north = vec2f(horizon_code(north_west, field.x), horizon_code(north_east, field.x));
        let steps = gains * (vec4f(south, north) + bitcast<f32>(field.w));
        let along = mix(steps.xz, steps.yw, cell.share.x);
        let value_rad = bitcast<f32>(field.z) + bitcast<f32>(field.y) * mix(along.x, along.y, cell.share.y);
        let wave = select(turned, vec2f(turned.y, -turned.x), real % 2u == 1u);
        sum += value_rad * vec2f(wave.x, -f32(order) * wave.y);
    }
    return sum;
}

// Elevation of the skyline, in radians, and its derivative by map azimuth, at a grid point counted in nodes from the
// first seen one, towards the unit map direction (X, Y) = (sin A, cos A).
fn horizon_elevation(horizon: HorizonGrid, grid: vec2f, towards: vec2f) -> vec2f {
    // Where each page's entries end in the table.
    let ends = horizon_texel(horizon.table);
    let step = towards.yx;
    let compressed = horizon_page(horizon, 0u, horizon.offset_0, vec2u(1u, ends.x), grid, step)
        + horizon_page(horizon, 1u, horizon.offset_1, vec2u(ends.x, ends.y), grid, step)
        + horizon_page(horizon, 2u, horizon.offset_2, vec2u(ends.y, ends.z), grid, step)
        + horizon_page(horizon, 3u, horizon.offset_3, vec2u(ends.z, ends.w), grid, step);
    let bent = HORIZON_GROWTH * compressed.x * compressed.x;
    return compressed * vec2f(1.0 + bent, 1.0 + 3.0 * bent);
}
