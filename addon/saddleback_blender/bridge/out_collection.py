import bpy
def replace_object(context, source, role, data):
    n=f"{source.name} {role}"
    o=bpy.data.objects.get(n)
    if o: o.data=data
    else:
        o=bpy.data.objects.new(n,data); context.scene.collection.objects.link(o)
    return o
def clear_outputs(context, source):
    k=0
    for a in [a.name for a in source.data.attributes if a.name.startswith('saddleback_')]:
        source.data.attributes.remove(source.data.attributes[a]); k+=1
    for o in list(bpy.data.objects):
        if o.name.startswith(source.name+' '): bpy.data.objects.remove(o); k+=1
    return k
