def write_vertex_attributes(obj, values):
    for n,v in values.items():
        t={'f':'FLOAT','i':'INT'}[v.dtype.kind]
        a=obj.data.attributes.get(n) or obj.data.attributes.new(n,t,'POINT')
        a.data.foreach_set('value',v)
    obj.data.update()
