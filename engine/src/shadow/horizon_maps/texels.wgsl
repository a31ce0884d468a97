// Texels of horizon maps. They may be larger than one binding: pages of 2^PAGE_BITS texels.

@group(0) @binding(0) var<storage, read> horizon_page_0: array<vec4u>;
@group(0) @binding(1) var<storage, read> horizon_page_1: array<vec4u>;
@group(0) @binding(2) var<storage, read> horizon_page_2: array<vec4u>;
@group(0) @binding(3) var<storage, read> horizon_page_3: array<vec4u>;

override PAGES: u32;
override PAGE_BITS: u32;

fn horizon_texel(index: u32) -> vec4u {
    let within = index & ((1u << PAGE_BITS) - 1u);
    let page = index >> PAGE_BITS;
    if PAGES == 1u || page == 0u {
        return horizon_page_0[within];
    }
    if PAGES == 2u || page == 1u {
        return horizon_page_1[within];
    }
    if PAGES == 3u || page == 2u {
        return horizon_page_2[within];
    }
    return horizon_page_3[within];
}
