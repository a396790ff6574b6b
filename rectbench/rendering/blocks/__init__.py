"""Blocks to build scenes from: shapes, finishes, houses, trees, furniture; all metric, pure NumPy.

A finish (`brick`, `timber` ...) covers a shape (`box`, `tubes` ...) and makes a `Model`; models move
as one, add up, and become the meshes of a `World` through `meshes` and `instances`.
"""

from rectbench.rendering.blocks.furniture import (
    TABLE_M as TABLE_M,
    blind as blind,
    bookcase as bookcase,
    books as books,
    cabinet as cabinet,
    chair as chair,
    desk_lamp as desk_lamp,
    door as door,
    extinguisher as extinguisher,
    floor_lamp as floor_lamp,
    lockers as lockers,
    monitor as monitor,
    notice_board as notice_board,
    parcel as parcel,
    pendant as pendant,
    picture as picture,
    radiator as radiator,
    sofa as sofa,
    step_ladder as step_ladder,
    stool as stool,
    table as table,
    vase as vase,
)
from rectbench.rendering.blocks.ground import (
    asphalt as asphalt,
    bark as bark,
    birch_bark as birch_bark,
    forest_floor as forest_floor,
    gravel as gravel,
    lawn as lawn,
)
from rectbench.rendering.blocks.houses import (
    HouseFinishes as HouseFinishes,
    Opening as Opening,
    house as house,
    pierced_wall as pierced_wall,
    window as window,
)
from rectbench.rendering.blocks.interiors import (
    OAK as OAK,
    PINE as PINE,
    WALNUT as WALNUT,
    cloth as cloth,
    enamel as enamel,
    floorboards as floorboards,
    rug as rug,
    timber as timber,
    wall_paint as wall_paint,
    wallpaper as wallpaper,
)
from rectbench.rendering.blocks.masonry import (
    BROWN_BRICK as BROWN_BRICK,
    RED_BRICK as RED_BRICK,
    YELLOW_BRICK as YELLOW_BRICK,
    brick as brick,
    ceiling_board as ceiling_board,
    concrete as concrete,
    glazed_tiles as glazed_tiles,
    paving as paving,
    plaster as plaster,
    roof_tiles as roof_tiles,
    stone_wall as stone_wall,
    terrazzo as terrazzo,
)
from rectbench.rendering.blocks.noise import (
    clouds as clouds,
    fractal as fractal,
)
from rectbench.rendering.blocks.plants import (
    bare_tree as bare_tree,
    birch as birch,
    broadleaf as broadleaf,
    bush as bush,
    fern as fern,
    grass_tuft as grass_tuft,
    hedge as hedge,
    log as log,
    posy as posy,
    potted_plant as potted_plant,
    spruce as spruce,
)
from rectbench.rendering.blocks.prints import (
    Prints as Prints,
    book_spines as book_spines,
    foliage as foliage,
    parcels as parcels,
    posters as posters,
    window_panes as window_panes,
)
from rectbench.rendering.blocks.shape import (
    Finish as Finish,
    Model as Model,
    Shape as Shape,
    copies as copies,
    join as join,
    meshes as meshes,
    placement as placement,
    scattered as scattered,
    stand as stand,
    together as together,
)
from rectbench.rendering.blocks.solids import (
    ball as ball,
    boulder as boulder,
    box as box,
    boxes as boxes,
    cable as cable,
    cards as cards,
    cylinder as cylinder,
    floor as floor,
    loft as loft,
    panel as panel,
    plank as plank,
    prism as prism,
    quads as quads,
    rod as rod,
    terrain as terrain,
    tubes as tubes,
    turned as turned,
)
from rectbench.rendering.blocks.street_things import (
    bench as bench,
    bicycle as bicycle,
    bollard as bollard,
    car as car,
    lamp_post as lamp_post,
    litter_bin as litter_bin,
    pillar_box as pillar_box,
    rail_fence as rail_fence,
    railing as railing,
)
